// Widgets of the lessons. All that they show was computed by the program and is in the element `data`.
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
        const radius = Math.max(6, this.side * 0.46);
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

/** The cells from a start along the pointers of a run. */
function followed(next, start) {
    const path = [start];
    while (next[path.at(-1)] >= 0 && path.length <= next.length) path.push(next[path.at(-1)]);
    return path;
}

/**
 * Runs on maps: fronts, searches and fields. `data-panes` is the number of runs side by side, `data-first` the runs that are
 * shown at first. A reader picks the start where a run has a pointer for every cell.
 */
function cellsWidget(root) {
    const isField = root.dataset.kind === "field";
    const firsts = (root.dataset.first || "0").split(" ").map(Number);
    let board = data.boards[0];
    let start = board.start;
    const panes = firsts.map((first) => {
        const pane = { run: first, note: element("p", { class: "note", "aria-live": "off" }) };
        pane.picture = new Picture(1, "map", (...canvas) => draw(pane, ...canvas));
        pane.cells = new Cells(pane.picture, board);
        pane.choice = choice("Method", [], (run) => ((pane.run = run), prepare()));
        pane.choice.select.setAttribute("aria-label", "method");
        pane.element = element("div", { class: "pane" }, pane.choice.label, pane.picture.canvas, pane.note);
        const picks = (cell) => {
            if (!board.runs[pane.run].next || board.walls[cell] === "1") return;
            start = cell;
            prepare(isField ? Infinity : player.step);
        };
        pane.picture.canvas.addEventListener("click", (event) => {
            const { cols } = board;
            picks(Math.floor(event.offsetY / pane.cells.side) * cols + Math.floor(event.offsetX / pane.cells.side));
        });
        pane.picture.canvas.addEventListener("keydown", (event) => {
            const by = { ArrowUp: -board.cols, ArrowDown: board.cols, ArrowLeft: -1, ArrowRight: 1 }[event.key];
            if (by === undefined || !board.runs[pane.run].next) return;
            event.preventDefault();
            // A wall in the way is jumped over.
            let cell = start + by;
            while (board.walls[cell] === "1") cell += by;
            const isSameRow = Math.floor(cell / board.cols) === Math.floor(start / board.cols);
            if (board.walls[cell] === "0" && (Math.abs(by) > 1 || isSameRow)) picks(cell);
        });
        return pane;
    });
    const stepsOf = (pane) => {
        const run = board.runs[pane.run];
        return isField ? followed(run.next, start).length - 1 : 1 + Math.max(...run.order);
    };
    const player = new Player(Number(root.dataset.seconds || 6), () => panes.forEach((pane) => (pane.picture.paint(), note(pane))));

    function prepare(step = 0) {
        for (const pane of panes) {
            pane.cells.board = board;
            pane.picture.aspect = board.rows / board.cols;
            const names = board.runs.map((run) => run.name);
            pane.run = Math.min(pane.run, names.length - 1);
            pane.choice.select.replaceChildren(...names.map((name, value) => element("option", { value: String(value) }, name)));
            pane.choice.select.value = String(pane.run);
            const run = board.runs[pane.run];
            pane.most = Math.max(...run.values.filter((value, cell) => value !== null && (!isField || board.walls[cell] === "0")));
            pane.picture.canvas.setAttribute("aria-label", `${board.name}: ${run.name}`);
            if (run.next) pane.picture.canvas.tabIndex = 0;
            else pane.picture.canvas.removeAttribute("tabindex");
        }
        player.reset(Math.max(...panes.map(stepsOf)), step);
    }

    function draw(pane, context, width, height) {
        const run = board.runs[pane.run];
        const [step, cells] = [player.step, pane.cells];
        const isSeen = (cell) => isField || (run.order[cell] >= 0 && run.order[cell] < step);
        const share = (cell) => run.values[cell] / pane.most;
        cells.ground(context, width, height, (cell) => isSeen(cell) && run.values[cell] !== null && colour(share(cell)));
        if (!isField && !run.path) {
            cells.numbers(context, (cell) => isSeen(cell) && [run.values[cell], board.walls[cell] === "1" || share(cell) < 0.6 ? "#ffffff" : "#202024"]);
        }
        if (isField) {
            const path = followed(run.next, start).slice(0, step + 1);
            cells.line(context, path.map((cell) => cells.centre(cell)), css("--path"));
            const end = path.at(-1);
            if (run.next[end] < 0 && end !== board.goal) cells.mark(context, end, "!");
        } else if (step >= stepsOf(pane)) {
            const path = run.path || (run.next ? followed(run.next, start) : []);
            cells.line(context, path.map((cell) => cells.centre(cell)), css("--path"));
        }
        if (run.next || run.path) {
            cells.mark(context, board.goal, "G");
            cells.mark(context, start, "S");
        }
    }

    function note(pane) {
        const run = board.runs[pane.run];
        const step = Math.min(player.step, stepsOf(pane));
        if (isField) {
            const path = followed(run.next, start);
            const end = path.at(-1) === board.goal ? "reaches the goal" : "gets stuck in a local minimum (!)";
            pane.note.textContent = `From S the descent ${end}. It reaches the goal from ${run.reached} of ${run.free} free cells.`;
        } else if (run.expanded === undefined) {
            const isShown = (cell) => run.order[cell] >= 0 && run.order[cell] < step && board.walls[cell] === "0";
            const shown = run.values.filter((_, cell) => isShown(cell));
            const largest = shown.length ? `; the largest is ${Math.max(...shown)}` : "";
            pane.note.textContent = `Step ${step} of ${stepsOf(pane)}: ${shown.length} free cells have a value${largest}.`;
        } else {
            const least = board.runs[0].cost;
            const excess = (100 * (run.cost / least - 1)).toFixed(1);
            const length = run.cost - least < 1e-6 ? "shortest possible" : `${excess} % longer than the shortest`;
            const bound = run.bound === null ? "no bound" : `bound ${run.bound.toFixed(2)}`;
            const end = step < run.expanded ? "" : ` Path length ${run.cost.toFixed(2)}: ${length} (${bound}).`;
            pane.note.textContent = `${step} cells expanded.${end}`;
        }
    }

    const boards = choice("Map", data.boards.map((other) => other.name), (value) => {
        board = data.boards[value];
        start = board.start;
        prepare(isField ? Infinity : 0);
    });
    const signs = [[css("--wall"), "obstacle"], [colour(0), "low value"], [colour(1), "high value"], [css("--path"), "path"]];
    root.prepend(
        element("div", { class: "bar" }, boards.label, ...player.controls),
        element("div", { class: "panes" }, ...panes.map((pane) => pane.element)),
        legend(signs),
    );
    prepare(isField ? Infinity : 0);
}

// Trees and roadmaps.

function treesWidget(root) {
    let board = data.boards[0];
    const panes = (root.dataset.first || "0").split(" ").map((first) => {
        const pane = { run: Number(first), note: element("p", { class: "note" }) };
        pane.picture = new Picture(1, "tree", (...canvas) => draw(pane, ...canvas));
        pane.cells = new Cells(pane.picture, board);
        pane.choice = choice("Method", board.runs.map((run) => run.name), (run) => ((pane.run = run), player.reset(board.runs[0].stages.length, player.step)));
        pane.choice.select.value = first;
        pane.element = element("div", { class: "pane" }, pane.choice.label, pane.picture.canvas, pane.note);
        return pane;
    });
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
        if (!shown) return (pane.note.textContent = "No samples yet.");
        const path = shown.cost === null ? "no path yet" : `path length ${shown.cost.toFixed(1)}`;
        pane.note.textContent = `Up to ${shown.samples} samples: ${shown.points.length} points, ${path}. Theta* needs ${board.costs.reference.toFixed(1)}.`;
        return undefined;
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
        player.reset(board.runs[0].stages.length, 4);
    }
    root.prepend(
        element("div", { class: "bar" }, boards.label, ...player.controls),
        element("div", { class: "panes" }, ...panes.map((pane) => pane.element)),
        legend([[css("--wall"), "obstacle"], [css("--focus"), "edge"], [css("--path"), "path"]]),
    );
    prepare();
}

/** The cost of RRT* over the number of samples, one line for each seed; the seeds appear one by one. */
function costsWidget(root) {
    let costs = data.boards[0].costs;
    const picture = new Picture(0.5, "path length over the number of samples", (context, width, height) => {
        const all = costs.seeds.flat().filter((cost) => cost !== null);
        const [low, high] = [costs.reference * 0.95, Math.max(...all) * 1.02];
        const [left, bottom] = [46, height - 36];
        const x = (i) => left + ((width - left - 16) * i) / (costs.samples.length - 1);
        const y = (cost) => bottom - ((bottom - 12) * (cost - low)) / (high - low);
        axes(context, { left, bottom, width, ticks: costs.samples.map((n, i) => [x(i), n]), title: "samples" });
        context.textAlign = "right";
        for (let i = 0; i < 5; i++) {
            const cost = low + ((high - low) * (i + 0.5)) / 5;
            context.fillText(cost.toFixed(1), left - 6, y(cost) + 4);
        }
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
        const found = seed && seed.find((cost) => cost !== null);
        note.textContent = seed ? `Seed ${step}: from ${found} to ${seed.at(-1)}; Theta* needs ${costs.reference}.` : "Play adds one seed after another.";
    });
    const boards = choice("Map", data.boards.map((board) => board.name), (value) => {
        costs = data.boards[value].costs;
        player.reset(costs.seeds.length);
    });
    root.prepend(element("div", { class: "bar" }, boards.label, ...player.controls), element("div", { class: "pane" }, picture.canvas), note,
        legend([[css("--path"), "this seed"], [css("--muted"), "other seeds"], [css("--good"), "Theta*"]]));
    player.reset(costs.seeds.length, 4);
}

function axes(context, { left, bottom, width, ticks, title }) {
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
    for (const [x, text] of ticks) context.fillText(text, x, bottom + 15);
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
        const pane = { kind, note: element("p", { class: "note" }) };
        pane.picture = new Picture(0.85, name, (...canvas) => draw(pane, ...canvas));
        pane.element = element("div", { class: "pane" }, element("strong", {}, name), pane.picture.canvas, pane.note);
        return pane;
    });
    const player = new Player(6, () => panes.forEach((pane) => pane.picture.paint()));
    function car(context, [x, y, heading], scale, style) {
        context.save();
        context.translate(x, y);
        context.rotate(-heading);
        context.lineWidth = 1.5;
        context.strokeStyle = style;
        // Rear axle at the origin: 5 m by 2.2 m, the nose ahead.
        context.strokeRect(-1 * scale, -1.1 * scale, 5 * scale, 2.2 * scale);
        context.beginPath();
        context.moveTo(4 * scale, 0);
        context.lineTo(2.4 * scale, -0.9 * scale);
        context.lineTo(2.4 * scale, 0.9 * scale);
        context.fillStyle = style;
        context.fill();
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
            const word = pane.kind === "dubins" ? curve.word : curve.word.replaceAll("-", "−");
            pane.note.textContent = `${curve.length.toFixed(1)} m, word ${word}. A holonomic robot needs ${Math.hypot(goal.x, goal.y).toFixed(1)} m.`;
        }
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
        const unit = Number((span / 2.4).toPrecision(1));
        const ticks = [-2, -1, 0, 1, 2].map((times) => [x(times * unit), signed(times * unit)]);
        axes(context, { left: 8, bottom, width, ticks, title: `difference per pair, B − A (${metric.unit})` });
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
        note.textContent = n < 2 ? `${n} pairs: an interval needs at least 2.` : `${n} pairs: mean ${signed(mean)}, 95 % interval ${signed(low)} to ${signed(high)} ${metric.unit}, width ${(high - low).toFixed(1)}. ${verdict}`;
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
        shown.forEach(({ mean, low, high }, i) => {
            const y = 8 + ((height - 16) * i) / intervals.length;
            const style = low > truth() || high < truth() ? css("--bad") : css("--muted");
            Cells.prototype.line(context, [[x(low), y], [x(high), y]], style, style === css("--bad") ? 2.5 : 1);
            context.fillStyle = style;
            context.fillRect(x(mean) - 1.5, y - 1.5, 3, 3);
        });
        Cells.prototype.line(context, [[width / 2, 2], [width / 2, height - 2]], css("--good"), 2);
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
        const pane = { policy: data.policies[Number(first)], note: element("p", { class: "note" }) };
        pane.picture = new Picture(1, "field", (...canvas) => draw(pane, ...canvas));
        pane.choice = choice("Policy", data.policies.map((policy) => policy.name), (value) => ((pane.policy = data.policies[value]), player.go(player.step)));
        pane.choice.select.value = first;
        pane.element = element("div", { class: "pane" }, pane.choice.label, pane.picture.canvas, pane.note);
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
        pane.note.textContent = `${Math.floor(second / 60)}:${String(second % 60).padStart(2, "0")} min: ${count(1)} burning, ${count(3)} extinguished, ${count(2)} burned out; ${count(0) + count(3)} of ${now.length} saved so far.`;
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
