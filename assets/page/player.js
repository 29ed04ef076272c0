// The player: keys, mouse, touch, and frames.

// The names of layers, where the program's are those of its options.
const LAYER_NAMES = {
    "grid-lines": "grid",
    "prm-query": "roadmap search",
    "local-search": "local search",
    "wumpus-search": "Wumpus search",
    ages: "seconds burning",
    suppression: "extinguishing",
    wet: "wet ground",
    arrival: "fire front",
    "fire-type": "fire type",
};

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60, 100, 200, 500, 1000];
const FIRST_SPEED = 60;
// A notch of the wheel, and a press of a button, magnify by these factors.
const NOTCH = Math.exp(0.2);
const PRESS = 1.5;
// The distance in pixels from which a pressed mouse drags instead of clicking.
const CLICK = 4;
// A hidden page continues where it stopped.
const LONGEST_FRAME_MS = 250;

// The compressed bytes in an element of the page.
function unpacked(id) {
    const letters = atob(document.getElementById(id).textContent);
    const packed = new Uint8Array(letters.length);
    // Millions of calls of a function would take longer.
    for (let index = 0; index < packed.length; index++) packed[index] = letters.charCodeAt(index);
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate")));
}

// The layers that show something in these runs, with their keys: T begins the tour.
function layersOf(data, runs) {
    const hasAgents = runs.some(({ agents }) => agents.length > 0);
    const hasBushes = runs.some(({ bushCells }) => bushCells.length > 0);
    const isThere = { paths: hasAgents, suppression: hasAgents, spread: hasBushes, ages: hasBushes };
    return data.layers.filter(({ name }) => isThere[name] ?? true).map((layer) => ({ ...layer, key: layer.key === "T" ? "B" : layer.key }));
}

// Plays runs. A host can handle clicks on a field, tells whether the runs are known to their ends, and is notified when
// everything known so far has been played.
const NO_HOST = { picks: () => false, isFinal: () => true, reachesEnd: () => {} };

class Player {
    constructor(data, host = NO_HOST) {
        this.data = data;
        this.host = host;
        this.runs = data.runs.map((run) => new Run(run));
        data.layers = layersOf(data, this.runs);
        this.endNs = Math.max(...this.runs.map((run) => run.end_ns));
        this.ns = Math.min(data.time_ns, this.endNs);
        this.speed = FIRST_SPEED;
        this.isPlaying = false;
        const [x, y, zoom] = data.camera;
        const layers = new Set(data.layers.filter(({ is_on }) => is_on).map(({ name }) => name));
        this.view = { camera: { x, y, zoom }, zooms: data.zooms, follows: data.follows, layers, selected: data.selected, marked: null, pixelRatio: 1, isOnTour: false, showsAhead: false, seenNs: 0 };
        this.isStale = true;
        this.pointers = new Map();
        this.makePanes();
        this.panel = new Panel(data, this.runs);
        this.makeControls();
        this.makeTimeline();
        this.makeKeys();
        this.listening = new AbortController();
        const { signal } = this.listening;
        document.addEventListener("keydown", (event) => this.press(event), { signal });
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw(), { signal });
        this.resizing = new ResizeObserver(() => this.redraw());
        [...this.panes.map(({ canvas }) => canvas), this.chart.canvas].forEach((canvas) => this.resizing.observe(canvas));
        requestAnimationFrame((now) => this.frame(now));
    }

    redraw() {
        this.isStale = true;
    }

    // Continues with more of the same runs.
    take(data) {
        this.runs.forEach((run, index) => Object.assign(run, new Run(data.runs[index])));
        data.layers = layersOf(data, this.runs);
        this.endNs = Math.max(...this.runs.map((run) => run.end_ns));
        this.chart.takeRuns();
        this.panes.forEach((pane) => (pane.groundKey = ""));
        if (data.layers.length !== this.data.layers.length) {
            this.data.layers = data.layers;
            this.makeLayers();
        }
        this.showEnd();
        this.redraw();
    }

    // Releases the page for another player.
    close() {
        this.isClosed = true;
        this.listening.abort();
        this.resizing.disconnect();
    }

    // Draws the changes since the last frame.
    frame(now) {
        if (this.isClosed) return;
        if (this.isPlaying && !this.isScrubbed) {
            const passed = Math.min(now - (this.lastFrame ?? now), LONGEST_FRAME_MS);
            this.ns = Math.min(this.ns + passed * 1e6 * this.speed, this.endNs);
            this.isStale = true;
            if (this.tour?.passes(this.ns)) {
                this.tour.next();
            } else if (this.ns === this.endNs) {
                this.setPlaying(false);
                this.host.reachesEnd();
            }
        }
        this.lastFrame = now;
        if (this.isStale) {
            this.isStale = false;
            this.draw();
        }
        requestAnimationFrame((next) => this.frame(next));
    }

    draw() {
        const { ns, view, panes } = this;
        view.pixelRatio = Math.max(1, devicePixelRatio);
        if (!view.isOnTour) view.seenNs = Math.max(view.seenNs, ns);
        this.panel.isFinal = this.host.isFinal();
        panes.forEach((pane) => {
            const size = [pane.canvas.clientWidth, pane.canvas.clientHeight].map((side) => Math.max(1, Math.round(side * view.pixelRatio)));
            if (pane.canvas.width !== size[0] || pane.canvas.height !== size[1]) {
                [pane.canvas.width, pane.canvas.height] = size;
            }
            pane.run.seek(Math.min(ns, pane.run.end_ns));
        });
        panes.forEach((pane, index) => pane.draw(ns, view, panes.length === 2 ? panes[1 - index].run : null));
        this.chart.draw(ns, view.pixelRatio, view.showsAhead ? this.endNs : view.seenNs);
        if (!this.tour) this.showCaption(this.panel.isFinal && !this.host.hasCard && ns === this.endNs ? this.verdict : "");
        this.panel.show(ns, view);
        document.getElementById("clock").textContent = formatClock(ns);
        const isNear = view.camera.zoom > 1 || view.follows !== null;
        panes.forEach(({ canvas }) => canvas.classList.toggle("is-near", isNear));
        this.timeline.setAttribute("aria-valuenow", `${Math.round(ns / NANOS)}`);
        this.timeline.setAttribute("aria-valuetext", formatClock(ns));
    }

    // The viewer's commands.

    seek(ns) {
        this.uncover();
        this.ns = clamp(ns, 0, this.endNs);
        this.redraw();
    }

    setPlaying(isPlaying) {
        if (isPlaying) this.uncover();
        this.isPlaying = isPlaying;
        document.body.classList.toggle("is-playing", isPlaying);
        document.getElementById("play").setAttribute("aria-label", isPlaying ? "pause" : "play");
    }

    // The results of the runs.
    get verdict() {
        return this.runs.map((run, index) => `${this.runs.length > 1 ? `${"AB"[index]}: ` : ""}${run.verdict}.`).join(" ");
    }

    // A sentence over the field, with a button of a tour; nothing hides it.
    showCaption(text, next = "") {
        const [caption, button] = ["caption", "caption-next"].map((id) => document.getElementById(id));
        caption.hidden = text === "";
        button.hidden = document.getElementById("caption-stop").hidden = next === "";
        if (button.textContent !== next) button.textContent = next;
        const words = document.getElementById("caption-text");
        if (words.textContent !== text) words.textContent = text;
    }

    // The next stop of the tour, which begins if there is none; not while the run is still computed.
    tourOn() {
        if (this.tour) this.tour.next();
        else if (this.host.isFinal()) this.tour = new Tour(this);
    }

    endTour() {
        const { tour } = this;
        this.tour = null;
        tour.restore();
        this.redraw();
    }

    // Shows or hides what comes in the time line.
    toggleAhead() {
        this.view.showsAhead = !this.view.showsAhead;
        document.getElementById("ahead").setAttribute("aria-pressed", `${this.view.showsAhead}`);
        this.redraw();
    }

    // Removes the cover over the field before the run is played.
    uncover() {
        const cover = document.getElementById("cover");
        if (cover.classList.contains("choice")) return;
        if (cover.contains(document.activeElement)) document.getElementById("play").focus();
        cover.hidden = true;
    }

    togglePlaying() {
        if (!this.isPlaying && this.ns === this.endNs) this.seek(0);
        this.setPlaying(!this.isPlaying);
    }

    // The clock pauses at an event, so that it can be seen.
    stepTo(times) {
        if (times.length === 0) return;
        this.setPlaying(false);
        this.seek(times[0]);
    }

    nextEvent() {
        const next = this.runs.map(({ moments }) => moments[lastAt(moments, this.ns) + 1]);
        this.stepTo(next.filter((time) => time !== undefined).sort((one, other) => one - other));
    }

    previousEvent() {
        const last = this.runs.map(({ moments }) => {
            const at = lastAt(moments, this.ns);
            return moments[at] === this.ns ? moments[at - 1] : moments[at];
        });
        this.stepTo(last.filter((time) => time !== undefined).sort((one, other) => other - one));
    }

    setSpeed(speed) {
        this.speed = speed;
        document.getElementById("speed").value = `${speed}`;
    }

    faster() {
        this.setSpeed(SPEEDS.find((speed) => speed > this.speed) ?? this.speed);
    }

    slower() {
        this.setSpeed(SPEEDS.findLast((speed) => speed < this.speed) ?? this.speed);
    }

    follow(whom) {
        this.view.follows = whom;
        document.getElementById("follow").value = whom ?? "";
        this.redraw();
    }

    followNext() {
        const all = this.followed();
        this.follow(all[all.indexOf(this.view.follows) + 1] ?? null);
    }

    // The camera's options: follow nobody, the fleet, or an agent.
    followed() {
        const { agents } = this.runs[0];
        const isFleet = agents.filter(({ is_truck }) => is_truck).length > 1;
        return [null, ...(isFleet ? ["fleet"] : []), ...agents.map(({ id }) => id)];
    }

    wholeField() {
        this.view.camera = { x: 0.5, y: 0.5, zoom: 1 };
        this.follow(null);
    }

    toggleLayer(name) {
        const { layers } = this.view;
        if (!layers.delete(name)) layers.add(name);
        this.showLayers();
        this.redraw();
    }

    select(selected) {
        this.view.selected = selected;
        this.redraw();
    }

    // The camera of the current view, regardless of who is followed.
    cameraNow() {
        const { run, canvas } = this.panes[0];
        return cameraOf(run, Math.min(this.ns, run.end_ns), this.view, canvas.width, canvas.height);
    }

    // Zooms by a factor; the point at a place of a pane, in its own pixels, stays there.
    zoom(pane, factor, at) {
        const { run, canvas } = pane;
        const camera = this.cameraNow();
        const [least, most] = this.view.zooms;
        const zoomed = { ...camera, zoom: clamp(camera.zoom * factor, least, most) };
        const under = new Projection(run, camera, canvas.width, canvas.height).world(at);
        const then = new Projection(run, zoomed, canvas.width, canvas.height).world(at);
        this.moveTo(run, zoomed, under.x - then.x, under.y - then.y);
        if (this.view.follows === "fleet") this.follow(null);
    }

    // Moves the view by a number of pixels to the right and down, and stops following.
    pan({ run, canvas }, right, down) {
        const camera = this.cameraNow();
        const { scale } = new Projection(run, camera, canvas.width, canvas.height);
        this.moveTo(run, camera, -right / scale, down / scale);
        this.follow(null);
    }

    moveTo(run, camera, eastM, northM) {
        const x = clamp(camera.x + eastM / run.widthM, 0, 1);
        const y = clamp(camera.y + northM / run.heightM, 0, 1);
        this.view.camera = { ...camera, x, y };
        this.redraw();
    }

    saveStill() {
        const [wide, high] = [this.panes.reduce((sum, { canvas }) => sum + canvas.width, 0), this.panes[0].canvas.height];
        const sheet = Object.assign(document.createElement("canvas"), { width: wide, height: high });
        let left = 0;
        for (const { canvas } of this.panes) {
            sheet.getContext("2d").drawImage(canvas, left, 0);
            left += canvas.width;
        }
        const link = element("a");
        const names = this.runs.map((run) => `${run.title.replace(/[^\p{L}\p{N}_-]/gu, "_").slice(0, 40)}-seed-${run.seed}`);
        link.download = `${names.join("-and-")}-${(this.ns / NANOS).toFixed(1)}s.png`;
        link.href = sheet.toDataURL("image/png");
        link.click();
    }

    // Creates the elements that never change.

    makePanes() {
        const panes = document.getElementById("panes");
        panes.classList.toggle("two", this.runs.length > 1);
        this.panes = this.runs.map((run, index) => {
            const [figure, canvas] = [element("figure"), element("canvas")];
            if (this.runs.length > 1) figure.append(element("figcaption", `${"AB"[index]}  ${run.title}, seed ${run.seed}`));
            canvas.style.setProperty("--aspect", `${clamp(run.widthM / run.heightM, 0.6, 2.2)}`);
            canvas.tabIndex = 0;
            canvas.setAttribute("aria-label", `the field of ${run.title}, seed ${run.seed}`);
            figure.append(canvas);
            panes.append(figure);
            const pane = new FieldPane(canvas, this.data, run, index);
            this.listenToPane(pane);
            return pane;
        });
        document.getElementById("program").textContent = `wildfire ${[...new Set(this.runs.map(({ program }) => program))].join(", ")}`;
        this.showEnd();
    }

    showEnd() {
        document.getElementById("end").textContent = `of ${formatClock(this.endNs)}`;
        document.getElementById("timeline").setAttribute("aria-valuemax", `${Math.round(this.endNs / NANOS)}`);
    }

    // One finger or the mouse moves the field, two fingers and the wheel magnify it, a tap or click selects.
    listenToPane(pane) {
        const { canvas } = pane;
        const place = (event) => {
            const { left, top } = canvas.getBoundingClientRect();
            return [(event.clientX - left) * this.view.pixelRatio, (event.clientY - top) * this.view.pixelRatio];
        };
        canvas.addEventListener("pointerdown", (event) => {
            canvas.setPointerCapture(event.pointerId);
            this.pointers.set(event.pointerId, { at: place(event), from: place(event), isDragged: this.pointers.size > 0 });
        });
        canvas.addEventListener("pointermove", (event) => {
            const pointer = this.pointers.get(event.pointerId);
            if (pointer === undefined) return;
            const [before, at] = [pointer.at, place(event)];
            const other = [...this.pointers.values()].find((held) => held !== pointer);
            pointer.isDragged ||= Math.hypot(at[0] - pointer.from[0], at[1] - pointer.from[1]) >= CLICK * this.view.pixelRatio;
            if (!pointer.isDragged) return;
            pointer.at = at;
            if (other === undefined) {
                this.pan(pane, at[0] - before[0], at[1] - before[1]);
                return;
            }
            const apart = ([x, y]) => Math.max(1, Math.hypot(x - other.at[0], y - other.at[1]));
            const middle = ([x, y]) => [0.5 * (x + other.at[0]), 0.5 * (y + other.at[1])];
            this.pan(pane, middle(at)[0] - middle(before)[0], middle(at)[1] - middle(before)[1]);
            this.zoom(pane, apart(at) / apart(before), middle(at));
        });
        canvas.addEventListener("pointerup", (event) => {
            const pointer = this.pointers.get(event.pointerId);
            if (pointer === undefined || pointer.isDragged) return;
            const at = place(event);
            if (!this.host.picks(pane, at)) this.select(pane.pick(at));
        });
        for (const end of ["pointerup", "pointercancel"]) {
            canvas.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
        }
        const wheel = (event) => {
            event.preventDefault();
            const pixels = event.deltaY * (event.deltaMode === 0 ? 1 : 33);
            this.zoom(pane, NOTCH ** clamp(-pixels / 100, -3, 3), place(event));
        };
        canvas.addEventListener("wheel", wheel, { passive: false });
    }

    makeControls() {
        const middle = (pane) => [0.5 * pane.canvas.width, 0.5 * pane.canvas.height];
        const does = {
            "to-start": () => this.seek(0),
            previous: () => this.previousEvent(),
            play: () => this.togglePlaying(),
            cover: (event) => this.leaveCover(event),
            next: () => this.nextEvent(),
            "to-end": () => this.seek(this.endNs),
            "zoom-in": () => this.zoom(this.panes[0], PRESS, middle(this.panes[0])),
            "zoom-out": () => this.zoom(this.panes[0], 1 / PRESS, middle(this.panes[0])),
            whole: () => this.wholeField(),
            "show-keys": () => document.getElementById("keys").showModal(),
            forget: () => this.select(null),
            tour: () => this.tourOn(),
            ahead: () => this.toggleAhead(),
            "caption-next": () => this.tourOn(),
            "caption-stop": () => this.endTour(),
        };
        for (const [id, act] of Object.entries(does)) document.getElementById(id).addEventListener("click", act);
        const [speed, follow] = ["speed", "follow"].map((id) => document.getElementById(id));
        speed.append(...SPEEDS.map((times) => Object.assign(element("option", `${times} \u00d7`), { value: `${times}` })));
        speed.addEventListener("change", () => this.setSpeed(Number(speed.value)));
        this.setSpeed(this.speed);
        follow.append(...this.followed().map((whom) => Object.assign(element("option", whom ?? "nobody"), { value: whom ?? "" })));
        follow.addEventListener("change", () => this.follow(follow.value === "" ? null : follow.value));
        this.follow(this.view.follows);
        this.makeLayers();
    }

    // The cover of a recorded run plays it, or begins the tour; that of a game has buttons of its own.
    leaveCover(event) {
        if (event.currentTarget.classList.contains("choice")) return;
        if (event.target.id === "begin-tour") this.tourOn();
        else this.togglePlaying();
    }

    makeLayers() {
        this.layerButtons = this.data.layers.map(({ name, key }) => {
            const button = element("button");
            button.append(element("kbd", key), LAYER_NAMES[name] ?? name);
            Object.assign(button, { type: "button" });
            button.addEventListener("click", () => this.toggleLayer(name));
            return { name, button };
        });
        document.getElementById("layers").replaceChildren(...this.layerButtons.map(({ button }) => button));
        this.showLayers();
    }

    showLayers() {
        this.layerButtons.forEach(({ name, button }) => button.setAttribute("aria-pressed", `${this.view.layers.has(name)}`));
    }

    makeTimeline() {
        this.timeline = document.getElementById("timeline");
        const canvas = this.timeline.querySelector("canvas");
        this.chart = new Chart(canvas, this.data, this.runs);
        canvas.style.height = `${this.chart.height}px`;
        const scrub = (event) => this.seek(this.chart.timeAt(event.clientX - canvas.getBoundingClientRect().left));
        canvas.addEventListener("pointerdown", (event) => {
            canvas.setPointerCapture(event.pointerId);
            this.isScrubbed = true;
            scrub(event);
        });
        canvas.addEventListener("pointermove", (event) => this.isScrubbed && scrub(event));
        for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (this.isScrubbed = false));
    }

    makeKeys() {
        const table = document.querySelector("#keys table");
        const layers = this.data.layers.map(({ name, key }) => [key, `layer: ${LAYER_NAMES[name] ?? name}`]);
        const own = [["T", "guided tour, its next stop"], ["X", "show or hide what comes in the time line"]];
        setRows(table, [...own, ...this.data.keys, ...layers].map((row) => ["", ...row]));
    }

    press(event) {
        const isField = event.target.matches?.("select, input, textarea") || document.getElementById("keys").open;
        if (isField || event.ctrlKey || event.metaKey || event.altKey) return;
        // The space bar presses a focused button.
        const isPressed = event.target instanceof HTMLButtonElement && event.target.matches(":focus-visible");
        if (event.key === " " && isPressed) return;
        const seconds = (event.shiftKey ? 60 : 10) * NANOS;
        const does = {
            " ": () => this.togglePlaying(),
            ".": () => this.nextEvent(),
            ",": () => this.previousEvent(),
            arrowleft: () => this.seek(this.ns - seconds),
            arrowright: () => this.seek(this.ns + seconds),
            "+": () => this.faster(),
            "=": () => this.faster(),
            "-": () => this.slower(),
            home: () => this.seek(0),
            end: () => this.seek(this.endNs),
            z: () => this.wholeField(),
            f: () => this.followNext(),
            t: () => this.tourOn(),
            x: () => this.toggleAhead(),
            escape: () => (this.tour ? this.endTour() : this.select(null)),
            s: () => this.saveStill(),
            "?": () => document.getElementById("keys").showModal(),
            h: () => document.getElementById("keys").showModal(),
        };
        const key = event.key.toLowerCase();
        const layer = this.data.layers.find((other) => other.key.toLowerCase() === key);
        const act = does[key] ?? (layer && (() => this.toggleLayer(layer.name)));
        if (act === undefined) return;
        event.preventDefault();
        act();
    }
}
