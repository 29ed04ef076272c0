// Widgets of the lessons. What runs and samples show was computed by the program and is in the element `data`.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches;
const css = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();

function element(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (key in made && typeof value !== "string") made[key] = value;
        else made.setAttribute(key, value);
    }
    made.append(...children);
    return made;
}

function choice(label, names, onchange) {
    const select = element("select", {}, ...names.map((name, value) => element("option", { value: String(value) }, name)));
    select.addEventListener("change", () => onchange(Number(select.value)));
    return { select, label: element("label", {}, `${label} `, select) };
}

/** Colours from dark blue to yellow, by a share from 0 to 1. */
function colour(share) {
    const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
    const at = Math.max(0, Math.min(1, share)) * (stops.length - 1);
    const from = Math.min(Math.floor(at), stops.length - 2);
    const mixed = stops[from].map((part, i) => Math.round(part + (stops[from + 1][i] - part) * (at - from)));
    return `rgb(${mixed.join(" ")})`;
}

/** Round numbers in a range, at most `most` of them, as numbers and as text. */
function ticks(low, high, most = 6) {
    const power = 10 ** Math.floor(Math.log10((high - low) / most));
    const step = [1, 2, 5, 10].map((times) => times * power).find((step) => (high - low) / step <= most);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const first = Math.ceil(low / step - 1e-9);
    const count = Math.floor(high / step + 1e-9) - first + 1;
    return Array.from({ length: count }, (_, i) => [(first + i) * step, ((first + i) * step).toFixed(decimals).replace("-", "−")]);
}

const commandLine = () => element("code", { class: "command" });

/** Shows a command; an option stays on one line with its value. */
function showCommand(code, text) {
    code.replaceChildren(...text.split(/ (?=--)/).flatMap((part, i) => (i ? [" ", element("span", {}, part)] : [part])));
}

/** A canvas that is redrawn in sharp pixels whenever its width changes; draw(context, width, height) uses CSS pixels. */
class Picture {
    constructor(aspect, label, draw) {
        Object.assign(this, { aspect, draw });
        this.canvas = element("canvas", { role: "img", "aria-label": label });
        new ResizeObserver(() => this.paint()).observe(this.canvas);
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint());
    }

    paint() {
        const width = this.canvas.clientWidth;
        if (width === 0) return;
        const height = Math.round(width * this.aspect);
        const scale = devicePixelRatio || 1;
        if (this.canvas.width !== Math.round(width * scale) || this.canvas.height !== Math.round(height * scale)) {
            this.canvas.width = Math.round(width * scale);
            this.canvas.height = Math.round(height * scale);
        }
        const context = this.canvas.getContext("2d");
        context.setTransform(scale, 0, 0, scale, 0, 0);
        context.clearRect(0, 0, width, height);
        context.font = "12px Arimo, Arial, sans-serif";
        this.draw(context, width, height);
    }
}

/** Play, step and slider over a number of steps; show(step) is called for each. */
class Player {
    constructor(seconds, show) {
        Object.assign(this, { seconds, show, step: 0, steps: 1, timer: null });
        this.play = element("button", { type: "button", class: "play" }, "Play");
        this.forward = element("button", { type: "button", "aria-label": "one step forward" }, "Step");
        this.slider = element("input", { type: "range", min: "0", value: "0", "aria-label": "step" });
        this.play.addEventListener("click", () => (this.timer ? this.pause() : this.begin()));
        this.forward.addEventListener("click", () => (this.pause(), this.go(this.step + 1)));
        this.slider.addEventListener("input", () => (this.pause(), this.go(Number(this.slider.value))));
    }

    get controls() {
        return [this.play, this.forward, this.slider];
    }

    /** Begins again with a number of steps, at the step given. */
    reset(steps, step = 0) {
        this.pause();
        this.steps = Math.max(1, steps);
        this.slider.max = String(this.steps);
        this.go(step);
    }

    go(step) {
        this.step = Math.max(0, Math.min(this.steps, step));
        this.slider.value = String(this.step);
        this.show(this.step);
        if (this.step === this.steps) this.pause();
    }

    begin() {
        if (this.step === this.steps) this.go(0);
        this.play.textContent = "Pause";
        let last = performance.now();
        let owed = 0;
        const tick = (now) => {
            owed += ((now - last) / 1000 / this.seconds) * this.steps;
            last = now;
            this.timer = requestAnimationFrame(tick);
            if (owed >= 1) {
                const whole = Math.floor(owed);
                owed -= whole;
                this.go(this.step + whole);
            }
        };
        this.timer = requestAnimationFrame(tick);
    }

    pause() {
        cancelAnimationFrame(this.timer);
        this.timer = null;
        this.play.textContent = "Play";
    }
}

function legend(entries) {
    const sign = ([style, text]) => element("span", {}, element("i", { style: `background: ${style}` }), text);
    return element("div", { class: "legend" }, ...entries.map(sign));
}

// Maps of cells.

class Cells {
    constructor(picture, board) {
        Object.assign(this, { picture, board });
    }

    get side() {
        return this.picture.canvas.clientWidth / this.board.cols;
    }

    centre(cell) {
        const { cols } = this.board;
        return [((cell % cols) + 0.5) * this.side, (Math.floor(cell / cols) + 0.5) * this.side];
    }

    ground(context, width, height, paint) {
        const { rows, cols, walls } = this.board;
        const side = this.side;
        context.fillStyle = css("--void");
        context.fillRect(0, 0, width, height);
        for (let cell = 0; cell < rows * cols; cell++) {
            const fill = walls[cell] === "1" ? css("--wall") : paint(cell);
            if (!fill) continue;
            context.fillStyle = fill;
            context.fillRect((cell % cols) * side, Math.floor(cell / cols) * side, side + 0.5, side + 0.5);
        }
        context.strokeStyle = css("--faint");
        context.lineWidth = 0.5;
        context.beginPath();
        for (let col = 0; col <= cols; col++) context.moveTo(col * side, 0), context.lineTo(col * side, height);
        for (let row = 0; row <= rows; row++) context.moveTo(0, row * side), context.lineTo(width, row * side);
        context.stroke();
    }

    numbers(context, text) {
        if (this.side < 15) return;
        context.font = `${Math.min(12, this.side * 0.48)}px Arimo, Arial, sans-serif`;
        context.textAlign = "center";
        context.textBaseline = "middle";
        for (let cell = 0; cell < this.board.walls.length; cell++) {
            const written = text(cell);
            if (!written) continue;
            context.fillStyle = written[1];
            context.fillText(written[0], ...this.centre(cell));
        }
    }

    line(context, points, style, width = 3) {
        if (points.length < 2) return;
        context.strokeStyle = style;
        context.lineWidth = width;
        context.lineJoin = context.lineCap = "round";
        context.beginPath();
        points.forEach((point, i) => (i ? context.lineTo(...point) : context.moveTo(...point)));
        context.stroke();
    }

    mark(context, cell, letter) {
        const [x, y] = this.centre(cell);
        const radius = Math.max(8, this.side * 0.46);
        context.beginPath();
        context.arc(x, y, radius, 0, 7);
        context.fillStyle = "#ffffff";
        context.fill();
        context.strokeStyle = context.fillStyle = "#202024";
        context.lineWidth = 1.5;
        context.stroke();
        context.font = `bold ${Math.round(radius * 1.3)}px Arimo, Arial, sans-serif`;
        context.textAlign = "center";
        context.textBaseline = "middle";
        context.fillText(letter, x, y + 0.5);
    }
}

// The algorithms of `wildfire map`, computed here so that a reader can change the maps. Neighbours, ties and the order of
// floating-point operations are those of the program; `.ci/lessons` compares them with what the commands print.

const CROSS_FIRST = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]];
const WEST_FIRST = [[0, -1], [-1, 0], [0, 1], [1, 0], [-1, -1], [-1, 1], [1, 1], [1, -1]];

/** The cells that legal steps lead to, in the order of the steps. */
function stepsFrom({ rows, cols, cutsCorners }, walls, cell, steps) {
    const [row, col] = [Math.floor(cell / cols), cell % cols];
    const isFree = (row, col) => row >= 0 && row < rows && col >= 0 && col < cols && walls[row * cols + col] !== "1";
    const keepsCorners = ([down, right]) => cutsCorners || (isFree(row + down, col) && isFree(row, col + right));
    const legal = steps.filter((step) => isFree(row + step[0], col + step[1]) && keepsCorners(step));
    return legal.map(([down, right]) => cell + down * cols + right);
}

/** Values of a front that spreads from some cells: the first value there, one more with each step, 0 beyond. */
function front(board, walls, from, first, neighbours) {
    const values = board.walls.map(() => 0);
    const queue = [...from];
    for (const cell of queue) values[cell] = first;
    // The queue grows while it is read.
    for (const cell of queue) {
        for (const next of stepsFrom(board, walls, cell, CROSS_FIRST.slice(0, neighbours))) {
            if (!values[next]) queue.push(next), (values[next] = values[cell] + 1);
        }
    }
    return values;
}

/** Rows and columns between two cells. */
function apart(a, b, cols) {
    return [Math.floor(a / cols) - Math.floor(b / cols), (a % cols) - (b % cols)].map(Math.abs);
}

function brushfire(board, { neighbours }) {
    const obstacles = [...board.walls.keys()].filter((cell) => board.walls[cell] === "1");
    const values = front(board, [], obstacles, 1, neighbours);
    return { values, order: values.map((value) => value - 1) };
}

function wavefront(board, { neighbours }) {
    const reached = front(board, board.walls, [board.goal], 2, neighbours);
    const values = reached.map((value, cell) => (board.walls[cell] === "1" ? 1 : value));
    const around = (cell) => stepsFrom(board, board.walls, cell, CROSS_FIRST.slice(0, neighbours));
    const onwards = (cell) => around(cell).find((to) => values[to] === values[cell] - 1);
    const next = values.map((value, cell) => (value > 2 ? onwards(cell) : -1));
    return { values, order: values.map((value) => value - 2), next };
}

function total(board, { distance = "d2", eta }) {
    const { cols, goal, walls } = board;
    const nearest = brushfire(board, { neighbours: 8 }).values;
    const pull = walls.map((_, cell) => {
        const [rows, columns] = apart(cell, goal, cols);
        return distance === "d2" ? 0.5 * (rows * rows + columns * columns) : rows + columns;
    });
    const [most, q] = [Math.max(...pull), 5];
    const push = (value) => (value === 0 || value > q ? 0 : 0.5 * eta * (1 / value - 1 / q) * (1 / value - 1 / q));
    const values = pull.map((value, cell) => (value / most) * 10 + push(nearest[cell]));
    const next = walls.map((wall, cell) => {
        if (wall === "1" || cell === goal) return -1;
        const around = stepsFrom(board, walls, cell, WEST_FIRST);
        const lowest = around.reduce((low, to) => (values[to] < values[low] ? to : low), cell);
        return lowest === cell ? -1 : lowest;
    });
    return { values, next };
}

function bestFirst(board, { command, heuristic = "zero", weight = 1, neighbours }) {
    const { cols, start, goal, walls } = board;
    const estimate = (cell) => {
        const [rows, columns] = apart(cell, goal, cols);
        const octile = Math.abs(rows - columns) + Math.min(rows, columns) * Math.SQRT2;
        return { zero: 0, euclidean: Math.sqrt(rows * rows + columns * columns), octile, manhattan: rows + columns }[heuristic];
    };
    const nodes = walls.map((_, index) => ({ index, cost: Infinity, straight: 0, diagonal: 0, parent: -1, order: -1 }));
    const open = new Set([nodes[start]]);
    const closed = new Set();
    Object.assign(nodes[start], { cost: 0, priority: weight * estimate(start) });
    const isBefore = (a, b) => a.priority - b.priority || b.cost - a.cost || a.index - b.index;
    let expanded = 0;
    while (open.size > 0) {
        const here = [...open].reduce((best, node) => (isBefore(node, best) < 0 ? node : best));
        open.delete(here);
        closed.add(here);
        if (here.index === goal) break;
        here.order = expanded++;
        for (const to of stepsFrom(board, walls, here.index, CROSS_FIRST.slice(0, neighbours))) {
            const [node, isStraight] = [nodes[to], [1, cols].includes(Math.abs(to - here.index))];
            const cost = command === "greedy" ? 0 : here.cost + (isStraight ? 1 : Math.SQRT2);
            if (closed.has(node) || cost >= node.cost) continue;
            const [straight, diagonal] = [here.straight + (isStraight ? 1 : 0), here.diagonal + (isStraight ? 0 : 1)];
            Object.assign(node, { cost, straight, diagonal, parent: here.index, priority: cost + weight * estimate(to) });
            open.add(node);
        }
    }
    const path = closed.has(nodes[goal]) ? followed(nodes.map((node) => node.parent), goal).reverse() : [];
    // The Manhattan distance is at most the square root of 2 times the octile one.
    const excess = heuristic === "manhattan" && neighbours === 8 ? Math.SQRT2 : 1;
    const bound = heuristic === "zero" ? 1 : Math.max(1, weight * excess);
    const values = nodes.map((node) => (node.cost < Infinity ? node.straight + node.diagonal * Math.SQRT2 : null));
    const cost = path.length ? values[goal] : null;
    const order = nodes.map((node) => node.order);
    return { values, order, path, cost, expanded, bound: command === "greedy" ? null : bound };
}

const ALGORITHMS = { brushfire, wavefront, descend: total, astar: bestFirst, dijkstra: bestFirst, greedy: bestFirst };

/** The options of a command as numbers and names. */
function options(args) {
    const [command, ...rest] = args.split(" ");
    const found = { command, neighbours: 8 };
    const value = (text) => (Number.isNaN(Number(text)) ? text : Number(text));
    for (let i = 0; i < rest.length; i += 2) found[rest[i].slice(2)] = value(rest[i + 1]);
    return found;
}

/** The cells from a start along the pointers of a run. */
function followed(next, start) {
    const path = [start];
    while (next[path.at(-1)] >= 0 && path.length <= next.length) path.push(next[path.at(-1)]);
    return path;
}

const place = (cell, cols, between = ",") => `${Math.floor(cell / cols)}${between}${cell % cols}`;

function steps(path, cols) {
    const diagonal = path.filter((cell, i) => i > 0 && ![1, cols].includes(Math.abs(cell - path[i - 1]))).length;
    return `${path.length - 1} steps, length ${(path.length - 1 - diagonal + diagonal * Math.SQRT2).toFixed(3)}`;
}

/** The command that computes what a pane shows, with the map's file beside it. */
function mapCommand(board, args) {
    const [command, ...rest] = args.split(" ");
    const [start, goal] = [board.start, board.goal].map((cell) => place(cell, board.cols));
    const corners = board.cutsCorners === false ? ["--no-corner-cutting"] : [];
    const ends = command === "brushfire" ? [] : ["--start", start, "--goal", goal, ...corners];
    return ["wildfire map", command, board.file, ...ends, ...rest].join(" ");
}

const SAVE = "The commands compute the same on the map that is shown; save it first: ";

/** Makes a link save a board's map as the text that `wildfire map` reads. */
function saveMap(link, { cols, walls, file }) {
    const text = [...walls].map((wall, cell) => ((cell + 1) % cols ? wall : `${wall}\n`)).join("");
    link.href = `data:text/plain,${encodeURIComponent(text)}`;
    link.download = link.textContent = file;
}

/** Lets a reader change a pane's board by dragging, clicks and keys; change() of the editor is called after each change. */
function makeEditable(pane, editor) {
    const canvas = pane.picture.canvas;
    let [held, from, hasMoved] = [null, -1, false];
    const board = () => editor.board;
    const isFree = (cell) => cell >= 0 && board().walls[cell] === "0" && cell !== board().start && cell !== board().goal;
    const cellAt = ({ clientX, clientY }) => {
        const box = canvas.getBoundingClientRect();
        const [col, row] = [clientX - box.left, clientY - box.top].map((at) => Math.floor(at / pane.cells.side));
        return col >= 0 && row >= 0 && col < board().cols && row < board().rows ? row * board().cols + col : -1;
    };
    const itemAt = (event) => {
        const box = canvas.getBoundingClientRect();
        const far = (end) => {
            const [x, y] = pane.cells.centre(board()[end]);
            return Math.hypot(x - event.clientX + box.left, y - event.clientY + box.top);
        };
        const reach = Math.max(14, pane.cells.side * 0.6);
        const ends = pane.hasEnds ? ["start", "goal"].filter((end) => far(end) < reach) : [];
        if (ends.length) return ends.sort((a, b) => far(a) - far(b))[0];
        return board().walls[cellAt(event)] === "1" ? "wall" : null;
    };
    const setWall = (cell, wall) => ((board().walls[cell] = wall), (board().file = board().changedFile));
    const move = (what, cell) => {
        if (!isFree(cell)) return false;
        if (what === "wall") setWall(from, "0"), setWall((from = cell), "1");
        else if (what === "draw") setWall(cell, "1");
        else if (pane.hasEnds) board()[what] = cell;
        editor.change();
        return true;
    };
    // A finger on what can be dragged does not scroll the page.
    const keep = (event) => (itemAt(event.touches[0]) || editor.tool === "draw") && event.preventDefault();
    canvas.addEventListener("touchstart", keep, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
        [held, from, hasMoved] = [itemAt(event), cellAt(event), false];
        if (!held && editor.tool === "draw") held = move("draw", from) ? "draw" : null;
        if (held) canvas.setPointerCapture(event.pointerId), canvas.focus();
    });
    canvas.addEventListener("pointermove", (event) => {
        if (held && cellAt(event) !== from) hasMoved = move(held, cellAt(event)) || hasMoved;
        else if (!held) canvas.style.cursor = itemAt(event) ? "grab" : "crosshair";
    });
    canvas.addEventListener("pointerup", (event) => {
        if (!held && editor.tool !== "draw" && cellAt(event) === from) move(editor.tool, from);
        if (held === "wall" && !hasMoved && editor.tool === "draw") setWall(from, "0"), editor.change();
        held = null;
    });
    canvas.addEventListener("pointercancel", () => (held = null));
    canvas.addEventListener("keydown", (event) => {
        const by = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
        const isDrawing = editor.tool === "draw";
        if (!by && !(isDrawing && [" ", "Enter"].includes(event.key))) return;
        event.preventDefault();
        const { rows, cols, walls } = board();
        const next = (cell) => {
            const [row, col] = [Math.floor(cell / cols) + by[0], (cell % cols) + by[1]];
            return row >= 0 && row < rows && col >= 0 && col < cols ? row * cols + col : -1;
        };
        if (!by) {
            if (walls[editor.cursor] === "1") setWall(editor.cursor, "0"), editor.change();
            else move("draw", editor.cursor);
        } else if (isDrawing) {
            const to = next(editor.cursor);
            from = editor.cursor;
            // With Shift a wall is taken along.
            if (to >= 0 && (!event.shiftKey || walls[from] !== "1" || move("wall", to))) editor.cursor = to;
            editor.paint();
        } else {
            // A wall in the way is jumped over.
            let to = next(board()[editor.tool]);
            while (to >= 0 && !isFree(to)) to = next(to);
            move(editor.tool, to);
        }
    });
}

/** Runs on maps: fronts, searches and fields. `data-first` names the runs that are shown side by side at first. */
function cellsWidget(root) {
    const isField = root.dataset.kind === "field";
    const editor = {
        tool: "start",
        cursor: 0,
        change: () => prepare(player.step < player.steps ? player.step : Infinity),
        paint: () => panes.forEach((pane) => pane.picture.paint()),
    };
    let board = null;
    let number = 0;
    const panes = (root.dataset.first || "0").split(" ").map((first) => {
        const pane = { number: Number(first), note: element("p", { class: "note" }), command: commandLine() };
        pane.picture = new Picture(1, "map", (...canvas) => draw(pane, ...canvas));
        Object.assign(pane.picture.canvas, { tabIndex: 0 }).setAttribute("role", "application");
        pane.cells = new Cells(pane.picture, data.boards[0]);
        pane.choice = choice("Method", [], (run) => ((pane.number = run), prepare(isField ? Infinity : player.step)));
        pane.choice.select.setAttribute("aria-label", "method");
        pane.element = element("div", { class: "pane" }, pane.choice.label, pane.picture.canvas, pane.note, pane.command);
        makeEditable(pane, editor);
        for (const event of ["focus", "blur"]) pane.picture.canvas.addEventListener(event, editor.paint);
        return pane;
    });
    const stepsOf = ({ run }) => (isField ? followed(run.next, board.start).length - 1 : 1 + Math.max(-1, ...run.order));
    const player = new Player(Number(root.dataset.seconds || 6), () => panes.forEach((pane) => (pane.picture.paint(), note(pane))));
    const link = element("a", {});

    function open() {
        const { file, walls } = data.boards[number];
        board = { ...data.boards[number], walls: [...walls], changedFile: `my-${file}`, cutsCorners: corners.checked };
        [editor.board, editor.cursor] = [board, board.start];
        prepare(isField ? Infinity : 0);
    }

    function prepare(step) {
        saveMap(link, board);
        for (const pane of panes) {
            const names = board.runs.map((run) => run.name);
            pane.number = Math.min(pane.number, names.length - 1);
            pane.choice.select.replaceChildren(...names.map((name, value) => element("option", { value: String(value) }, name)));
            pane.choice.select.value = String(pane.number);
            const { args } = board.runs[pane.number];
            pane.run = ALGORITHMS[options(args).command](board, options(args));
            pane.hasEnds = options(args).command !== "brushfire";
            showCommand(pane.command, mapCommand(board, args));
            pane.cells.board = board;
            pane.picture.aspect = board.rows / board.cols;
            const isScaled = (value, cell) => value !== null && (!isField || board.walls[cell] === "0");
            pane.most = Math.max(1, ...pane.run.values.filter(isScaled));
            const label = `${board.name}: ${names[pane.number]}. Arrow keys move what is chosen under Edit.`;
            pane.picture.canvas.setAttribute("aria-label", label);
            // In this mode a finger draws; else it scrolls the page.
            pane.picture.canvas.style.touchAction = editor.tool === "draw" ? "none" : "manipulation";
        }
        player.reset(Math.max(...panes.map(stepsOf)), step);
    }

    function draw(pane, context, width, height) {
        const run = pane.run;
        const [step, cells] = [player.step, pane.cells];
        const isSeen = (cell) => isField || (run.order[cell] >= 0 && run.order[cell] < step);
        const share = (cell) => run.values[cell] / pane.most;
        cells.ground(context, width, height, (cell) => isSeen(cell) && run.values[cell] !== null && colour(share(cell)));
        if (!isField && !run.path) {
            cells.numbers(context, (cell) => isSeen(cell) && [run.values[cell], board.walls[cell] === "1" || share(cell) < 0.6 ? "#ffffff" : "#202024"]);
        }
        const path = (run.path || (run.next ? followed(run.next, board.start) : [])).slice(0, isField ? step + 1 : undefined);
        if (isField || step >= stepsOf(pane)) cells.line(context, path.map((cell) => cells.centre(cell)), css("--path"));
        if (pane.hasEnds) {
            const end = path.at(-1);
            if (isField && !run.order && run.next[end] < 0 && end !== board.goal) cells.mark(context, end, "!");
            cells.mark(context, board.goal, "G");
            cells.mark(context, board.start, "S");
        }
        if (editor.tool === "draw" && document.activeElement === pane.picture.canvas) {
            const [x, y] = cells.centre(editor.cursor);
            context.strokeStyle = css("--path");
            context.lineWidth = 2.5;
            context.strokeRect(x - cells.side / 2, y - cells.side / 2, cells.side, cells.side);
        }
    }

    function note(pane) {
        const run = pane.run;
        const [last, step] = [stepsOf(pane), Math.min(player.step, stepsOf(pane))];
        const free = board.walls.filter((wall) => wall === "0").length;
        const path = run.path || (run.next ? followed(run.next, board.start) : []);
        const none = "No path leads from S to G";
        const row = (cell) => `row ${place(cell, board.cols, ", column ")}`;
        let text = "";
        if (isField) {
            const isReached = (wall, cell) => wall === "0" && followed(run.next, cell).at(-1) === board.goal;
            const reached = board.walls.filter(isReached).length;
            const failed = run.order ? none : `Stuck at ${row(path.at(-1))} (!)`;
            const end = path.at(-1) === board.goal ? "Reached the goal" : failed;
            text = step < last ? `Step ${step} of ${last}: at ${row(path[step])}.` : `${end}: ${steps(path, board.cols)}.`;
            text += ` The goal is reached from ${reached} of ${free} free cells.`;
        } else if (run.expanded === undefined) {
            const isShown = (cell) => run.order[cell] >= 0 && run.order[cell] < step && board.walls[cell] === "0";
            const shown = run.values.filter((_, cell) => isShown(cell));
            const largest = shown.length ? `; the largest is ${Math.max(...shown)}` : "";
            text = `Step ${step} of ${last}: ${shown.length} of ${free} free cells have a value${largest}.`;
            const end = path.at(-1) === board.goal ? `Path: ${steps(path, board.cols)}` : none;
            if (step === last && run.next) text += ` ${end}.`;
        } else {
            text = `${step} cells expanded.`;
            if (step === last && run.cost === null) text += ` ${none}.`;
            else if (step === last) {
                const { neighbours } = options(board.runs[pane.number].args);
                const least = bestFirst(board, { command: "dijkstra", neighbours }).cost;
                const excess = `${(100 * (run.cost / least - 1)).toFixed(1)} % longer than the shortest`;
                const length = run.cost - least < 1e-6 ? "shortest possible" : excess;
                const bound = run.bound === null ? "no bound" : `bound ${run.bound.toFixed(2)}`;
                text += ` Path: ${steps(path, board.cols)}; ${length} (${bound}).`;
            }
        }
        pane.note.textContent = text;
    }

    const boards = choice("Map", data.boards.map((other) => other.name), (value) => ((number = value), open()));
    const tools = ["start", "goal", "draw"];
    const tool = choice("Edit", ["start S", "goal G", "walls"], (value) => ((editor.tool = tools[value]), prepare(player.step)));
    const corners = element("input", { type: "checkbox", checked: true });
    corners.addEventListener("change", () => ((board.cutsCorners = corners.checked), editor.change()));
    const again = element("button", { type: "button" }, "Reset map");
    again.addEventListener("click", open);
    const signs = [[css("--wall"), "obstacle"], [colour(0), "low value"], [colour(1), "high value"], [css("--path"), "path"]];
    root.prepend(
        element("div", { class: "bar" }, boards.label, tool.label, again, element("label", {}, corners, " cut corners")),
        element("div", { class: "bar" }, ...player.controls),
        element("div", { class: "panes" }, ...panes.map((pane) => pane.element)),
        legend(signs),
    );
    root.append(element("p", { class: "hint" }, SAVE, link, "."));
    open();
}

// Trees and roadmaps.

function treesWidget(root) {
    let board = data.boards[0];
    const panes = (root.dataset.first || "0").split(" ").map((first) => {
        const pane = { run: Number(first), note: element("p", { class: "note" }), command: commandLine() };
        pane.picture = new Picture(1, "tree", (...canvas) => draw(pane, ...canvas));
        pane.cells = new Cells(pane.picture, board);
        pane.choice = choice("Method", board.runs.map((run) => run.name), (run) => ((pane.run = run), player.reset(board.runs[0].stages.length, player.step)));
        pane.choice.select.value = first;
        pane.element = element("div", { class: "pane" }, pane.choice.label, pane.picture.canvas, pane.note, pane.command);
        return pane;
    });
    const link = element("a", {});
    const player = new Player(3, () => panes.forEach((pane) => (pane.picture.paint(), note(pane))));
    const stage = (pane) => board.runs[pane.run].stages[player.step - 1];

    function draw(pane, context, width, height) {
        const cells = pane.cells;
        const at = ([row, col]) => [(col + 0.5) * cells.side, (row + 0.5) * cells.side];
        cells.ground(context, width, height, () => null);
        const shown = stage(pane);
        if (shown) {
            context.strokeStyle = css("--focus");
            context.lineWidth = 0.8;
            context.beginPath();
            for (const [from, to] of shown.edges) {
                context.moveTo(...at(shown.points[from]));
                context.lineTo(...at(shown.points[to]));
            }
            context.stroke();
            cells.line(context, shown.path.map(at), css("--path"), 3.5);
        }
        cells.mark(context, board.start, "S");
        cells.mark(context, board.goal, "G");
    }

    function note(pane) {
        const shown = stage(pane);
        const path = !shown || shown.cost === null ? "no path yet" : `path length ${shown.cost.toFixed(2)}`;
        const graph = shown && `${shown.points.length} points and ${shown.edges.length} edges, ${path}`;
        const theta = `Theta* needs ${board.costs.reference.toFixed(2)}`;
        pane.note.textContent = shown ? `At most ${shown.samples} samples: ${graph}. ${theta}.` : "No samples yet.";
        const { args, stages } = board.runs[pane.run];
        showCommand(pane.command, `${mapCommand(board, args)} --samples ${(shown || stages[0]).samples}`);
    }

    const boards = choice("Map", data.boards.map((other) => other.name), (value) => {
        board = data.boards[value];
        prepare();
    });
    function prepare() {
        for (const pane of panes) {
            pane.cells.board = board;
            pane.picture.aspect = board.rows / board.cols;
        }
        saveMap(link, board);
        player.reset(board.runs[0].stages.length, 4);
    }
    root.append(element("p", { class: "hint" }, SAVE, link, "."));
    root.prepend(
        element("div", { class: "bar" }, boards.label, ...player.controls),
        element("div", { class: "panes" }, ...panes.map((pane) => pane.element)),
        legend([[css("--wall"), "obstacle"], [css("--focus"), "edge"], [css("--path"), "path"]]),
    );
    prepare();
}

/** The cost of RRT* over the number of samples, one line for each seed; the seeds appear one by one. */
function costsWidget(root) {
    let board = data.boards[0];
    let costs = board.costs;
    const command = commandLine();
    const picture = new Picture(0.5, "path length over the number of samples", (context, width, height) => {
        const all = costs.seeds.flat().concat([costs.reference]).filter((cost) => cost !== null);
        const rounded = ticks(Math.min(...all), Math.max(...all));
        const unit = rounded[1][0] - rounded[0][0];
        const [low, high] = [Math.floor(Math.min(...all) / unit) * unit, Math.ceil(Math.max(...all) / unit) * unit];
        const [left, bottom] = [46, height - 36];
        const x = (i) => left + ((width - left - 16) * i) / (costs.samples.length - 1);
        const y = (cost) => bottom - ((bottom - 12) * (cost - low)) / (high - low);
        axes(context, { left, bottom, width, marks: costs.samples.map((n, i) => [x(i), n]), title: "samples" });
        context.textAlign = "right";
        for (const [cost, text] of ticks(low, high, 10)) context.fillText(text, left - 6, y(cost) + 4);
        const line = (points, style, thick) => Cells.prototype.line(context, points, style, thick);
        line([[left, y(costs.reference)], [width - 16, y(costs.reference)]], css("--good"), 2);
        costs.seeds.slice(0, player.step).forEach((seed, number) => {
            const points = seed.map((cost, i) => cost !== null && [x(i), y(cost)]).filter(Boolean);
            line(points, number === player.step - 1 ? css("--path") : css("--muted"), number === player.step - 1 ? 3 : 1);
        });
    });
    const note = element("p", { class: "note" });
    const player = new Player(4, (step) => {
        picture.paint();
        const seed = costs.seeds[step - 1];
        const first = seed && seed.findIndex((cost) => cost !== null);
        const [least, most] = [costs.samples[first], costs.samples.at(-1)];
        const found = seed && `${seed[first].toFixed(2)} with ${least} samples, ${seed.at(-1).toFixed(2)} with ${most}`;
        const theta = `Theta* needs ${costs.reference.toFixed(2)}`;
        note.textContent = seed ? `Seed ${step}: path length ${found}. ${theta}.` : "Play adds one seed after another.";
        showCommand(command, `${mapCommand(board, "rrt-star")} --seed ${Math.max(1, step)} --samples ${most}`);
    });
    const boards = choice("Map", data.boards.map((other) => other.name), (value) => {
        [board, costs] = [data.boards[value], data.boards[value].costs];
        player.reset(costs.seeds.length);
    });
    root.prepend(element("div", { class: "bar" }, boards.label, ...player.controls), element("div", { class: "pane" }, picture.canvas), note, command,
        legend([[css("--path"), "this seed"], [css("--muted"), "other seeds"], [css("--good"), "Theta*"]]));
    player.reset(costs.seeds.length, 4);
}

function axes(context, { left, bottom, width, marks, title }) {
    context.strokeStyle = css("--muted");
    context.fillStyle = css("--muted");
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(left, 8);
    context.lineTo(left, bottom);
    context.lineTo(width - 8, bottom);
    context.stroke();
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    for (const [x, text] of marks) {
        context.fillText(text, x, bottom + 15);
        context.fillRect(x - 0.5, bottom, 1, 4);
    }
    context.fillText(title, (left + width) / 2, bottom + 31);
}

// Curves.

function curvesWidget(root) {
    let [goal, turn] = [data.goals[0], 0];
    const kinds = [["reeds_shepp", "Reeds-Shepp (forward and reverse)"], ["dubins", "Dubins (forward only)"]];
    /** Poses along a curve, about every half metre; closed form along arcs. */
    const poses = (curve) => {
        const all = [[0, 0, 0, 1]];
        for (const [curvature, length] of curve.segments) {
            const parts = Math.max(1, Math.ceil(Math.abs(length) / 0.5));
            const [x, y, heading] = all.at(-1);
            for (let part = 1; part <= parts; part++) {
                const s = (length * part) / parts;
                const h = heading + curvature * s;
                const dx = curvature ? (Math.sin(h) - Math.sin(heading)) / curvature : s * Math.cos(h);
                const dy = curvature ? (Math.cos(heading) - Math.cos(h)) / curvature : s * Math.sin(h);
                all.push([x + dx, y + dy, h, Math.sign(length)]);
            }
        }
        return all;
    };
    const panes = kinds.map(([kind, name]) => {
        const pane = { kind, name: name.split(" ")[0], note: element("p", { class: "note" }) };
        pane.picture = new Picture(0.85, name, (...canvas) => draw(pane, ...canvas));
        pane.element = element("div", { class: "pane" }, element("strong", {}, name), pane.picture.canvas, pane.note);
        return pane;
    });
    const command = commandLine();
    const player = new Player(6, () => panes.forEach((pane) => pane.picture.paint()));
    function car(context, [x, y, heading], scale, style) {
        context.save();
        context.translate(x, y);
        context.rotate(-heading);
        context.lineWidth = 1.5;
        context.strokeStyle = style;
        // Rear axle at the origin: 5 m by 2.2 m, the nose ahead.
        context.strokeRect(-1 * scale, -1.1 * scale, 5 * scale, 2.2 * scale);
        // A slender arrow along the car.
        context.beginPath();
        context.moveTo(-0.4 * scale, 0);
        context.lineTo(3.4 * scale, 0);
        for (const side of [-1, 1]) context.moveTo(3.4 * scale, 0), context.lineTo(2.3 * scale, side * 0.42 * scale);
        context.stroke();
        context.restore();
    }
    function draw(pane, context, width, height) {
        const all = panes.flatMap((other) => other.poses).concat([[goal.x, goal.y]]);
        const [xs, ys] = [all.map((pose) => pose[0]), all.map((pose) => pose[1])];
        const middle = [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
        const scale = Math.min(width / (Math.max(...xs) - Math.min(...xs) + 14), height / (Math.max(...ys) - Math.min(...ys) + 14));
        const at = ([x, y]) => [width / 2 + (x - middle[0]) * scale, height / 2 - (y - middle[1]) * scale];
        const onto = (pose) => [...at(pose), pose[2]];
        context.fillStyle = css("--plate");
        context.fillRect(0, 0, width, height);
        context.setLineDash([5, 5]);
        Cells.prototype.line(context, [at([0, 0]), at([goal.x, goal.y])], css("--muted"), 1.5);
        context.setLineDash([]);
        for (let i = 1; i < pane.poses.length; i++) {
            const style = pane.poses[i][3] > 0 ? css("--focus") : css("--path");
            Cells.prototype.line(context, [at(pane.poses[i - 1]), at(pane.poses[i])], style, 2.5);
        }
        car(context, onto([0, 0, 0]), scale, css("--muted"));
        car(context, onto([goal.x, goal.y, (turn * data.degrees * Math.PI) / 180]), scale, css("--good"));
        const now = pane.poses[Math.round(((pane.poses.length - 1) * player.step) / player.steps)];
        car(context, onto(now), scale, css("--ink"));
    }
    function prepare() {
        for (const pane of panes) {
            const curve = goal.turns[turn][pane.kind];
            pane.poses = poses(curve);
            const word = curve.word ? `, ${curve.word}` : "";
            const straight = Math.hypot(goal.x, goal.y).toFixed(2);
            pane.note.textContent = `${pane.name}: ${curve.length.toFixed(2)} m${word}. A holonomic robot needs ${straight} m.`;
        }
        showCommand(command, `wildfire curve --from 0,0,0 --to ${goal.x},${goal.y},${turn * data.degrees} --radius ${data.radius}`);
        heading.nextElementSibling.textContent = `${turn * data.degrees}°`;
        player.reset(120, player.step);
    }
    const goals = choice("Goal", data.goals.map((other) => other.name), (value) => ((goal = data.goals[value]), prepare()));
    const heading = element("input", { type: "range", min: "0", max: String(360 / data.degrees - 1), value: "0", "aria-label": "heading at the goal" });
    heading.addEventListener("input", () => ((turn = Number(heading.value)), prepare()));
    root.prepend(
        element("div", { class: "bar" }, goals.label, element("label", {}, "Heading ", heading, element("output", {}))),
        element("div", { class: "bar" }, ...player.controls),
        element("div", { class: "panes" }, ...panes.map((pane) => pane.element)),
        command,
        legend([[css("--focus"), "forward"], [css("--path"), "reverse"], [css("--good"), "goal"], [css("--muted"), "start, straight line"]]),
    );
    prepare();
}

// Intervals.

/** A generator of whole numbers below n, so that a page shows the same every time it is opened (mulberry32). */
function dice(seed) {
    let state = seed;
    return (n) => {
        state = (state + 0x6d2b79f5) | 0;
        let t = Math.imul(state ^ (state >>> 15), 1 | state);
        t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) % n;
    };
}

function interval(values) {
    const n = values.length;
    const mean = values.reduce((sum, value) => sum + value, 0) / n;
    const squares = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
    const reach = n < 2 ? NaN : data.reach[n - 2] * Math.sqrt(squares / (n - 1) / n);
    return { mean, low: mean - reach, high: mean + reach };
}

const signed = (value) => (value < 0 ? "−" : value > 0 ? "+" : "") + Math.abs(value).toFixed(1);

function growingWidget(root) {
    let metric = data.metrics[0];
    const note = element("p", { class: "note" });
    const picture = new Picture(0.42, "differences of pairs and the interval of their mean", (context, width, height) => {
        const values = metric.differences.slice(0, player.step);
        const span = Math.max(...metric.differences.map(Math.abs)) * 1.05;
        const bottom = height - 36;
        const x = (value) => width / 2 + (value / span) * (width / 2 - 16);
        const marks = ticks(-span, span, width > 600 ? 12 : 6).map(([value, text]) => [x(value), text]);
        axes(context, { left: 8, bottom, width, marks, title: `difference per pair, B − A (${metric.unit})` });
        Cells.prototype.line(context, [[x(0), 8], [x(0), bottom]], css("--faint"), 1.5);
        const stacks = {};
        const dot = width > 600 ? 10 : 6;
        context.fillStyle = css("--focus");
        for (const value of values) {
            const place = Math.round(x(value) / dot);
            stacks[place] = (stacks[place] || 0) + 1;
            context.beginPath();
            context.arc(place * dot, bottom + 3 - stacks[place] * (dot - 1), dot * 0.4, 0, 7);
            context.fill();
        }
        if (values.length < 2) return;
        const { mean, low, high } = interval(values);
        const clipped = (value) => Math.max(9, Math.min(width - 9, x(value)));
        Cells.prototype.line(context, [[clipped(low), 18], [clipped(high), 18]], css("--path"), 4);
        context.beginPath();
        context.arc(x(mean), 18, 6, 0, 7);
        context.fillStyle = css("--path");
        context.fill();
    });
    const player = new Player(10, (n) => {
        picture.paint();
        const { mean, low, high } = interval(metric.differences.slice(0, n));
        const verdict = low > 0 || high < 0 ? "0 is outside: B and A differ." : "0 is inside: no evidence of a difference.";
        const ends = `${signed(low)} to ${signed(high)} ${metric.unit}, width ${(high - low).toFixed(1)}`;
        const found = `mean ${signed(mean)}, 95 % interval (Student's t) ${ends}. ${verdict}`;
        note.textContent = `${n} pairs: ${n < 2 ? "an interval needs at least 2." : found}`;
    });
    const more = element("button", { type: "button" }, "Add 5 seeds");
    more.addEventListener("click", () => player.go(player.step + 5));
    const metrics = choice("Metric", data.metrics.map((other) => other.name), (value) => ((metric = data.metrics[value]), player.go(player.step)));
    root.prepend(
        element("div", { class: "bar" }, metrics.label, more, ...player.controls),
        element("div", { class: "pane" }, picture.canvas),
        note,
        legend([[css("--focus"), "one pair of runs"], [css("--path"), "mean and 95 % interval"]]),
    );
    player.reset(metric.differences.length, 5);
}

/** Many experiments of the same size, each with its interval: some miss the mean of all pairs. */
function missesWidget(root) {
    let [metric, size, seed, intervals] = [data.metrics[0], 10, 1, []];
    const truth = () => interval(metric.differences).mean;
    const note = element("p", { class: "note" });
    const misses = (shown) => shown.filter(({ low, high }) => low > truth() || high < truth()).length;
    const picture = new Picture(0.7, "intervals of many experiments", (context, width, height) => {
        const shown = intervals.slice(0, player.step);
        const reach = Math.max(...intervals.map(({ low, high }) => Math.max(truth() - low, high - truth())));
        const x = (value) => width / 2 + ((value - truth()) / reach) * (width / 2 - 12);
        const bottom = height - 36;
        const marks = ticks(truth() - reach, truth() + reach, width > 600 ? 10 : 6).map(([value, text]) => [x(value), text]);
        axes(context, { left: 8, bottom, width, marks, title: `difference per pair, B − A (${metric.unit})` });
        shown.forEach(({ mean, low, high }, i) => {
            const y = 8 + ((bottom - 12) * i) / intervals.length;
            const style = low > truth() || high < truth() ? css("--bad") : css("--muted");
            Cells.prototype.line(context, [[x(low), y], [x(high), y]], style, style === css("--bad") ? 2.5 : 1);
            context.fillStyle = style;
            context.fillRect(x(mean) - 1.5, y - 1.5, 3, 3);
        });
        Cells.prototype.line(context, [[width / 2, 2], [width / 2, bottom]], css("--good"), 2);
    });
    const player = new Player(5, (step) => {
        picture.paint();
        const missed = misses(intervals.slice(0, step));
        note.textContent = `${step} experiments with ${size} pairs each: ${missed} intervals miss the mean of all ${data.seeds} pairs (${step ? ((100 * missed) / step).toFixed(1) : "0.0"} %). With 1000 experiments: ${thousand.toFixed(1)} %.`;
    });
    let thousand = 0;
    function experiments() {
        const roll = dice(seed);
        const one = () => interval(Array.from({ length: size }, () => metric.differences[roll(metric.differences.length)]));
        const all = Array.from({ length: 1000 }, one);
        intervals = all.slice(0, 100);
        thousand = misses(all) / 10;
        player.reset(intervals.length, 30);
    }
    const metrics = choice("Metric", data.metrics.map((other) => other.name), (value) => ((metric = data.metrics[value]), experiments()));
    const sizes = choice("Pairs", [5, 10, 20, 50].map(String), (value) => ((size = [5, 10, 20, 50][value]), experiments()));
    sizes.select.value = "1";
    const again = element("button", { type: "button" }, "New experiments");
    again.addEventListener("click", () => (seed++, experiments()));
    root.prepend(
        element("div", { class: "bar" }, metrics.label, sizes.label, again),
        element("div", { class: "bar" }, ...player.controls),
        element("div", { class: "pane" }, picture.canvas),
        note,
        legend([[css("--good"), "mean of all pairs"], [css("--muted"), "interval that contains it"], [css("--bad"), "interval that misses it"]]),
    );
    experiments();
}

// Runs of a fleet.

function fleetWidget(root) {
    let film = 0;
    const trucks = ["#0072b2", "#cc79a7", "#009e73"];
    const states = ["#7cb342", "#e65100", "#776d68", "#29b6f6"];
    const panes = (root.dataset.first || "0 3").split(" ").map((first) => {
        const pane = { policy: data.policies[Number(first)], note: element("p", { class: "note" }), command: commandLine() };
        pane.picture = new Picture(1, "field", (...canvas) => draw(pane, ...canvas));
        pane.choice = choice("Policy", data.policies.map((policy) => policy.name), (value) => ((pane.policy = data.policies[value]), player.go(player.step)));
        pane.choice.select.value = first;
        pane.element = element("div", { class: "pane" }, pane.choice.label, pane.picture.canvas, pane.note, pane.command);
        return pane;
    });
    const player = new Player(30, () => panes.forEach((pane) => (pane.picture.paint(), note(pane))));
    const stateAt = (run, second) => {
        const now = run.bushes.map(() => 0);
        for (const [time, bush, state] of run.changes) if (time <= second) now[bush] = state;
        return now;
    };
    function draw(pane, context, width, height) {
        const run = pane.policy.films[film];
        const scale = width / (run.cols * run.cell);
        const at = (x, y) => [x * scale, height - y * scale];
        const middle = (cell) => at(((cell % run.cols) + 0.5) * run.cell, (Math.floor(cell / run.cols) + 0.5) * run.cell);
        context.fillStyle = css("--field");
        context.fillRect(0, 0, width, height);
        const side = run.cell * scale;
        stateAt(run, player.step * data.step).forEach((state, bush) => {
            const [col, row] = run.bushes[bush];
            const [x, y] = at(col * run.cell, (row + 1) * run.cell);
            context.fillStyle = states[state];
            context.fillRect(x + 0.5, y + 0.5, side - 1, side - 1);
        });
        let number = 0;
        for (const agent of run.agents) {
            const [x, y, degrees, goal] = agent.states[player.step];
            const [px, py] = at(x, y);
            const style = agent.truck ? trucks[number++ % trucks.length] : css("--wumpus");
            if (agent.truck && goal >= 0) Cells.prototype.line(context, [[px, py], middle(goal)], style, 2);
            context.save();
            context.translate(px, py);
            context.rotate((-degrees * Math.PI) / 180);
            context.fillStyle = style;
            context.strokeStyle = "#ffffff";
            context.lineWidth = 1.5;
            context.beginPath();
            if (agent.truck) context.roundRect(-5, -5, 17, 10, 2);
            else context.arc(0, 0, 5, 0, 7);
            context.fill();
            context.stroke();
            context.restore();
        }
    }
    function note(pane) {
        const now = stateAt(pane.policy.films[film], player.step * data.step);
        const count = (state) => now.filter((other) => other === state).length;
        const second = player.step * data.step;
        const clock = `${Math.floor(second / 60)}:${String(second % 60).padStart(2, "0")} min`;
        const counts = `${count(1)} burning, ${count(3)} extinguished, ${count(2)} burned out`;
        pane.note.textContent = `${clock}: ${counts}, ${count(0)} of ${now.length} intact.`;
        const settings = `--set dispatch.policy=${pane.policy.name} --set duration_s=${data.duration}`;
        showCommand(pane.command, `wildfire run fleet --seed ${film + 1} ${settings}`);
    }
    const films = choice("Seed", data.policies[0].films.map((_, i) => String(i + 1)), (value) => ((film = value), player.go(0)));
    root.prepend(
        element("div", { class: "bar" }, films.label, ...player.controls),
        element("div", { class: "panes" }, ...panes.map((pane) => pane.element)),
        legend([...["intact", "burning", "burned out", "extinguished"].map((name, i) => [states[i], name]), [css("--wumpus"), "arsonist"], ["linear-gradient(90deg, #0072b2 33%, #cc79a7 33% 66%, #009e73 66%)", "trucks, each with a line to its goal"]]),
    );
    player.reset(data.duration / data.step, 30);
}

function savedTable(root) {
    const head = ["Policy", "Bushes saved, mean", "Difference from nearest", "95 % interval"];
    const rows = data.policies.map(({ name, saved, difference }, i) => {
        const mean = saved.reduce((sum, value) => sum + value, 0) / saved.length;
        const more = i ? [difference.mean, `${difference.low} to ${difference.high}`] : ["", ""];
        return element("tr", {}, element("th", { scope: "row" }, name), ...[mean.toFixed(1), ...more].map((text) => element("td", {}, text)));
    });
    root.append(element("table", {}, element("thead", {}, element("tr", {}, ...head.map((text) => element("th", { scope: "col" }, text)))), element("tbody", {}, ...rows)));
}

/** Questions: a button for each answer, whose `data-why` is the reason; the right one has `data-right`. */
function quiz(root) {
    for (const question of root.children) {
        const answer = element("p", { class: "answer", role: "status" });
        const buttons = [...question.querySelectorAll("button")];
        for (const button of buttons) {
            button.type = "button";
            button.addEventListener("click", () => {
                const isRight = "right" in button.dataset;
                buttons.forEach((other) => other.classList.remove("right", "wrong"));
                const verdict = isRight ? "right" : "wrong";
                button.classList.add(verdict);
                answer.className = `answer ${verdict}`;
                answer.textContent = `${isRight ? "Right." : "Not quite."} ${button.dataset.why}`;
            });
        }
        question.append(answer);
    }
}

const WIDGETS = { cells: cellsWidget, trees: treesWidget, costs: costsWidget, curves: curvesWidget, growing: growingWidget, misses: missesWidget, fleet: fleetWidget, saved: savedTable };
for (const root of document.querySelectorAll("[data-widget]")) WIDGETS[root.dataset.widget](root);
document.querySelectorAll(".quiz").forEach(quiz);
window.lesson = { isReady: true };
