// The pane of a field: bushes, fires, agents and layers, as in the program's pictures; positions and widths are those of
// crates/picture/src/film/field/. Parts that rarely change are kept on a separate canvas.

// Margin in pixels around a field that just fits its pane, and the largest visible distance in metres around a followed agent.
const FIELD_MARGIN = 8;
const FOLLOWED_M = 100;
// Panes whose shorter side has more pixels than this get wider lines and larger letters.
const ORDINARY_SIDE = 900;
// Cells with shorter sides than this are flat; those with longer ones than that are few, and drawn where they are.
const MIN_SPRITE = 8;
const MAX_STAMP = 96;
const STAMP_WIDTH = 1.8;
// Differently turned drawings of a bush.
const VARIANTS = 6;
// The share of its state's colour in the square of a bush.
const TINT = 0.45;
const MIN_FIRE = 3;

// Pictures of a flickering fire, and the sizes in which it grows.
const FIRE_FRAMES = 8;
const FRAMES_PER_SECOND = 8;
const FIRE_SIZES = 6;
const GROWS_FOR_S = 4;
const SMALLEST_FIRE = 0.45;
// Tongues, the ones behind first: place of the foot from the middle of the cell, and height, in cells.
const TONGUES = [[0.02, 0.02, 0.78], [-0.27, -0.2, 0.66], [0.27, -0.24, 0.6], [0.02, -0.4, 0.74]];
const STRETCH = [0.0, 0.1, 0.16, 0.06, -0.06, -0.12, -0.04, 0.08];
const LEAN = [0.0, 0.08, 0.14, 0.16, 0.06, -0.06, -0.14, -0.08];
const MIN_AGE = 22;

const RING_LASTS_NS = 5e9;
const SPREAD_LINE = "rgb(158, 50, 0)";
const DIFFERENT = "rgb(255, 0, 220)";

// Paths: driven parts fade in steps; dash and gap forward and in reverse.
const FADES_IN_NS = 120e9;
const FADING_STEPS = 12;
const MARKED_FADING_STEPS = 4;
const FRESH = 0.8;
const STALE = 0.12;
const FORWARD = [8, 5];
const REVERSE = [2, 3];
// Longer lines, in pixels, have no dashes, which would take a browser too long.
const MAX_DASHED = 3e5;
// Chord of a drawn arc to the arc, in pixels.
const ARC_TOLERANCE = 0.1;

// Bodies shorter than this are drawn this long, with a ring about them.
const MIN_WUMPUS = 13;
const MIN_UNIMOG = 18;
// The truck that the sprites are drawn for, in metres, and where its wheels are across.
const DRAWN_TRUCK_M = [4.9, 2.2];
const WHEEL_AT = 0.78;
// Marks of agents that are too many to be drawn as bodies.
const MARK_LENGTH = 11;
const MARK_RADIUS = 3.4;
const MARK_EDGE = 1;

// Fields of so many cells whose cells are smaller than so many pixels are shown by sums.
const MIN_CELLS = 100;
const MIN_CELL = 3;
// With more agents than this they are summarized.
const MAX_ONE_BY_ONE = 8;

// The em of the pictures' font in heights of its capitals.
const EM = 2048 / 1409;
const FONT = "Arimo, Arial, 'Liberation Sans', Helvetica, sans-serif";

// On a dark screen; ground is covered by a dark veil.
const DARK = {
    border: "#8a8372",
    faint: "#4c4d54",
    field: "#2b2a25",
    ink: "#e9e9ec",
    outside: "#191a1d",
    paper: "#16171a",
    unimog: "#ff8095",
    wumpus: "#d2a3ea",
};
const DARK_BURNED_OUT = "#8c857f";
const VEIL = "rgba(20, 20, 24, 0.45)";

const TAU = 2 * Math.PI;

function clamp(value, low, high) {
    return Math.min(Math.max(value, low), high);
}

function rgb(hex) {
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

function blend(under, over, share) {
    return under.map((channel, index) => Math.round(channel + (over[index] - channel) * share));
}

function css([red, green, blue], opacity = 1) {
    return `rgba(${red}, ${green}, ${blue}, ${opacity})`;
}

// A number that tells a cell from its neighbours: the mixing step of MurmurHash3 on its place.
function scatter({ col, row }) {
    let bits = (row << 16) | col;
    bits = Math.imul(bits ^ (bits >>> 16), 0x85ebca6b);
    bits = Math.imul(bits ^ (bits >>> 13), 0xc2b2ae35);
    return (bits ^ (bits >>> 16)) >>> 0;
}

// A map from points of a field, in metres, to places in a pane, in pixels.
class Projection {
    constructor(run, camera, width, height) {
        const room = (side) => Math.max(1, side - 2 * FIELD_MARGIN);
        const fitting = Math.min(room(width) / run.widthM, room(height) / run.heightM);
        this.scale = fitting * camera.zoom;
        this.left = 0.5 * width - camera.x * run.widthM * this.scale;
        this.top = 0.5 * height + camera.y * run.heightM * this.scale;
        this.run = run;
    }

    at({ x, y }) {
        return [this.left + x * this.scale, this.top - y * this.scale];
    }

    world([x, y]) {
        return { x: (x - this.left) / this.scale, y: (this.top - y) / this.scale };
    }

    // First pixels of a cell, and those after its last: cells side by side leave no gap.
    cell({ col, row }) {
        const side = this.run.cell_m;
        const [left, bottom] = this.at({ x: col * side, y: row * side }).map(Math.round);
        const [right, top] = this.at({ x: (col + 1) * side, y: (row + 1) * side }).map(Math.round);
        return [left, top, Math.max(right, left + 1), Math.max(bottom, top + 1)];
    }

    get cellSide() {
        return this.run.cell_m * this.scale;
    }

    key() {
        return `${this.scale} ${this.left} ${this.top}`;
    }
}

// Where the camera is: the viewer's, or about whom it follows.
function cameraOf(run, ns, view, width, height) {
    const camera = aimed(run, ns, view, width, height);
    return view.isOnTour ? within(run, camera, width, height) : camera;
}

// A camera that shows no more beyond the field than it must.
function within(run, { x, y, zoom }, width, height) {
    const { scale } = new Projection(run, { x, y, zoom }, width, height);
    const bounded = (middle, side, metres) => {
        const half = Math.min(0.5, (0.5 * side) / (scale * metres));
        return clamp(middle, half, 1 - half);
    };
    return { x: bounded(x, width, run.widthM), y: bounded(y, height, run.heightM), zoom };
}

function aimed(run, ns, view, width, height) {
    if (view.follows === "fleet") {
        const part = fleetBox(run, ns);
        return part === null ? view.camera : holding(run, part, width, height);
    }
    const agent = run.agents.find(({ id }) => id === view.follows);
    if (agent === undefined) return view.camera;
    const { x, y } = agent.centre(agent.at(ns));
    const near = Math.max(run.widthM, run.heightM) / FOLLOWED_M;
    const zoom = Math.min(Math.max(view.camera.zoom, near), view.zooms[1]);
    return { x: clamp(x / run.widthM, 0, 1), y: clamp(y / run.heightM, 0, 1), zoom };
}

// The camera that holds a part of a field as near as that goes.
function holding(run, { low, high }, width, height) {
    const whole = new Projection(run, { x: 0.5, y: 0.5, zoom: 1 }, width, height).scale;
    const room = (side) => Math.max(1, side - 2 * FIELD_MARGIN);
    const fitting = Math.min(room(width) / (high[0] - low[0]), room(height) / (high[1] - low[1])) / whole;
    const near = Math.max(run.widthM, run.heightM) / FOLLOWED_M;
    const zoom = clamp(Math.min(fitting, near), 1, 200);
    const middle = { x: (0.5 * (low[0] + high[0])) / run.widthM, y: (0.5 * (low[1] + high[1])) / run.heightM, zoom };
    return within(run, middle, width, height);
}

// The part of a field that a camera on the fleet keeps in view: the mean over a minute of the boxes about trucks at work, so
// that it moves with time and not with events, as in src/picture/film/fleet_view.rs.
function fleetBox(run, ns) {
    const [stepNs, steps] = [5e9, 6];
    const boxOf = (time, isMeant) => {
        const box = { low: [Infinity, Infinity], high: [-Infinity, -Infinity] };
        for (const agent of run.agents.filter(({ is_truck }) => is_truck)) {
            const state = agent.at(Math.min(time, run.end_ns));
            if (!isMeant(state)) continue;
            const { x, y } = agent.centre(state);
            [x, y].forEach((value, axis) => {
                box.low[axis] = Math.min(box.low[axis], value);
                box.high[axis] = Math.max(box.high[axis], value);
            });
        }
        return box.low[0] === Infinity ? null : box;
    };
    const joined = (one, other) => ({
        low: one.low.map((value, axis) => Math.min(value, other.low[axis])),
        high: one.high.map((value, axis) => Math.max(value, other.high[axis])),
    });
    const isAtWork = ({ activity }) => activity !== STANDING;
    const present = Math.floor(ns / stepNs);
    const begins = (number) => stepNs * Math.max(0, present + number - 2 * steps);
    const atWork = Array.from({ length: 4 * steps + 2 }, (_, number) => boxOf(begins(number), isAtWork));
    const [low, high] = [[0, 0], [0, 0]];
    let weights = 0;
    for (let number = steps; number <= 3 * steps + 1; number++) {
        const fromNow = number - 2 * steps - (ns % stepNs) / stepNs;
        const weight = Math.max(0, 1 - Math.abs(fromNow) / steps);
        const near = atWork.slice(number - steps, number + steps + 1).filter((box) => box !== null);
        const kept = near.length > 0 ? near.reduce(joined) : boxOf(begins(number), () => true);
        if (kept === null) return null;
        [0, 1].forEach((axis) => {
            low[axis] += weight * kept.low[axis];
            high[axis] += weight * kept.high[axis];
        });
        weights += weight;
    }
    let box = { low: low.map((value) => value / weights), high: high.map((value) => value / weights) };
    const now = boxOf(ns, isAtWork);
    if (now !== null) box = joined(box, now);
    const margin = 0.08 * Math.max(box.high[0] - box.low[0], box.high[1] - box.low[1]) + 30;
    return { low: box.low.map((value) => value - margin), high: box.high.map((value) => value + margin) };
}

// Shapes of a sprite that are ready to be drawn.
function readySprite(shapes) {
    return shapes.map(([colour, opacity, width, path]) => ({ colour: css(rgb(colour), opacity), width, path: new Path2D(path) }));
}

// The colour of rings about marked cells.
const MARKED = "#0072b2";

class FieldPane {
    constructor(canvas, data, run, runIndex) {
        Object.assign(this, { canvas, run, runIndex, data, isDark: null });
        this.styles = data.search_styles;
        this.context = canvas.getContext("2d", { alpha: false });
        this.sprites = Object.fromEntries(Object.entries(data.sprites).map(([name, shapes]) => [name, readySprite(shapes)]));
        this.ground = document.createElement("canvas");
        this.groundKey = "";
        this.stamps = new Map();
        this.stampSide = 0;
    }

    // Takes the colours of the screen.
    takeColours() {
        const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
        if (isDark === this.isDark) return;
        const { colours, state_colours } = this.data;
        this.isDark = isDark;
        this.colours = isDark ? { ...colours, ...DARK } : colours;
        this.stateColours = isDark ? state_colours.map((colour, kind) => (kind === BURNED_OUT ? DARK_BURNED_OUT : colour)) : state_colours;
    }

    colourOf(agent) {
        return this.colours[agent.is_truck ? "unimog" : "wumpus"];
    }

    get isCrowded() {
        return this.run.agents.length > MAX_ONE_BY_ONE;
    }

    // Whether cells are too small to see individually.
    get isByShares() {
        return this.projection.cellSide < MIN_CELL && Math.max(this.run.cols, this.run.rows) >= MIN_CELLS;
    }

    get hasMarks() {
        return this.isByShares && this.isCrowded;
    }

    shows(layer) {
        return this.view.layers.has(layer);
    }

    // Draws a time as a view asks for; `rival` is the other run of a comparison.
    draw(ns, view, rival) {
        const { width, height } = this.canvas;
        Object.assign(this, { ns: Math.min(ns, this.run.end_ns), view, rival });
        this.run.seek(this.ns);
        this.takeColours();
        this.projection = new Projection(this.run, cameraOf(this.run, this.ns, view, width, height), width, height);
        this.unit = Math.max(view.pixelRatio, Math.min(width, height) / ORDINARY_SIDE);
        this.states = this.run.agents.map((agent) => agent.at(this.ns));
        if (this.stampSide !== this.projection.cellSide) {
            this.stampSide = this.projection.cellSide;
            this.stamps.clear();
        }
        this.drawGround();
        this.context.setTransform(1, 0, 0, 1, 0, 0);
        this.context.drawImage(this.ground, 0, 0);
        if (this.run.ground !== null) this.drawGroundFire();
        if (this.isByShares && this.run.ground === null) this.drawGlows();
        if (this.shows("paths")) this.drawWays();
        if (this.shows("spread")) this.drawSpreads();
        if (this.isByShares) this.drawFireMarks(2.5);
        else this.drawFlames();
        this.drawDifferences();
        if (this.shows("suppression")) this.drawSuppressions();
        if (this.hasMarks) this.drawMarks();
        else this.run.agents.forEach((_, index) => this.drawAgent(index));
        if (this.isCrowded) this.drawLabels();
        this.drawSelected();
        if (view.marked !== null) this.drawMarked();
        if (this.isByShares) this.drawFireMarks(1);
        this.drawLengthBar();
        if (this.run.ground === null) return;
        if (this.shows("wind")) this.drawWind();
        if (this.groundShades() !== null) this.drawShadesBar();
    }

    // The parts kept between frames: the field, layers on the ground, and the bushes by state.
    drawGround() {
        const { width, height } = this.canvas;
        const searches = this.shownSearches();
        const shown = searches.map(({ search }) => this.run.searches.indexOf(search));
        // Sprites stick out of their cells, and are drawn over what burns beside them.
        const isBelowFire = this.run.ground !== null && this.projection.cellSide >= MIN_SPRITE;
        const changed = isBelowFire ? 0 : this.run.changed;
        const key = [this.projection.key(), this.isDark, width, height, [...this.view.layers], shown, changed].join("|");
        if (key === this.groundKey) return;
        this.groundKey = key;
        Object.assign(this.ground, { width, height });
        const context = this.ground.getContext("2d", { alpha: false });
        context.fillStyle = this.colours.outside;
        context.fillRect(0, 0, width, height);
        const [left, top] = this.projection.cell({ col: 0, row: this.run.rows - 1 });
        const [, , right, bottom] = this.projection.cell({ col: this.run.cols - 1, row: 0 });
        context.fillStyle = this.colours.border;
        context.fillRect(left - 2, top - 2, right - left + 4, bottom - top + 4);
        context.fillStyle = this.colours.field;
        context.fillRect(left, top, right - left, bottom - top);
        if (this.run.ground !== null && this.shows("ground")) {
            this.layCells(context, this.run.ground.covers);
            context.fillStyle = VEIL;
            if (this.isDark) context.fillRect(left, top, right - left, bottom - top);
        }
        if (this.shows("grid-lines")) this.drawGridLines(context, [left, top, right, bottom]);
        searches.forEach(({ search, style }) => this.drawSearch(context, search, style));
        this.drawWater(context);
        if (!isBelowFire) this.drawBushes(context);
    }

    drawGridLines(context, [left, top, right, bottom]) {
        const { run, projection } = this;
        context.fillStyle = css(blend(rgb(this.colours.field), rgb(this.colours.ink), 0.25));
        // Every cell, or as few as leave some pixels between: 1, 2 or 5 times a power of ten.
        const least = 6 / projection.cellSide;
        let step = 1;
        for (let factor = 0; step < least; factor++) step *= [2, 2.5, 2][factor % 3];
        for (let col = step; col < run.cols; col += step) {
            context.fillRect(projection.cell({ col, row: 0 })[0], top, 1, bottom - top);
        }
        for (let row = step; row < run.rows; row += step) {
            context.fillRect(left, projection.cell({ col: 0, row })[3] - 1, right - left, 1);
        }
    }

    shownSearches() {
        return this.styles.flatMap((style, index) => {
            if (!this.shows(style.layer)) return [];
            return this.run.searchesAt(index, this.ns).map((search) => ({ search, style }));
        });
    }

    // In the order in which the search visited them, from dark to light.
    drawSearch(context, search, { colours, width, opacity, disc }) {
        search.xs ??= sums(search.places, 2);
        search.ends ??= sums(search.edges);
        const place = (index) => this.projection.at({ x: search.xs[2 * index] / 100, y: search.xs[2 * index + 1] / 100 });
        const count = search.ends.length / 2;
        context.lineWidth = width * this.unit;
        for (let index = 0; index < count; index++) {
            const [from, to] = [place(search.ends[2 * index]), place(search.ends[2 * index + 1])];
            const colour = css(blend(colours[0], colours[1], index / Math.max(1, count - 1)), opacity);
            context.strokeStyle = colour;
            context.beginPath();
            context.moveTo(...from);
            context.lineTo(...to);
            context.stroke();
            if (disc > 0) this.disc(context, to, disc * this.projection.cellSide, colour);
        }
    }

    drawWater(context) {
        if (this.run.water === null) return;
        const { unit, colours, projection } = this;
        const reach = this.run.water.reach_m * projection.scale;
        const half = (this.hasMarks ? 2.5 : 6) * unit;
        for (const [east, north] of this.run.water.places_m) {
            const [x, y] = projection.at({ x: east, y: north });
            if (reach > half) {
                this.disc(context, [x, y], reach, css(rgb(colours.water), 0.1));
                this.ring(context, [x, y], reach, css(rgb(colours.water), 0.6), unit);
            }
            for (const [radius, colour] of [[half + 1.5 * unit, colours.paper], [half, colours.water]]) {
                const [up, across] = [radius / 2.2, radius * Math.sqrt(1 - 1 / 4.84)];
                this.area(context, [[x, y - 2.2 * radius], [x + across, y - up], [x - across, y - up]], colour);
                this.disc(context, [x, y], radius, colour);
            }
        }
    }

    drawBushes(context) {
        if (this.isByShares) this.drawShares(context);
        else if (this.projection.cellSide < MIN_SPRITE) this.drawFlatCells(context);
        else this.drawBushSprites(context);
    }

    // Where several cells share a pixel, burning ones win, and are some pixels wide at least.
    drawFlatCells(context) {
        for (const isBurning of [false, true]) {
            const beyond = isBurning && this.projection.cellSide < MIN_FIRE ? 1 : 0;
            this.run.kinds.forEach((kind, bush) => {
                if ((kind === BURNING) !== isBurning) return;
                const [left, top, right, bottom] = this.projection.cell(this.run.cell(this.run.bushCells[bush]));
                context.fillStyle = this.stateColours[kind];
                context.fillRect(left - beyond, top - beyond, right - left + 2 * beyond, bottom - top + 2 * beyond);
            });
        }
    }

    // From north to south, so that what sticks out of a cell lies over what is behind it.
    drawBushSprites(context) {
        const { run, projection } = this;
        const tints = this.stateColours.map((colour) => css(blend(rgb(this.colours.field), rgb(colour), TINT)));
        run.kinds.forEach((kind, bush) => {
            const [left, top, right, bottom] = projection.cell(run.cell(run.bushCells[bush]));
            context.fillStyle = tints[kind];
            context.fillRect(left, top, right - left, bottom - top);
        });
        const names = ["bush", "embers", "burned", "wet"];
        for (let bush = run.kinds.length - 1; bush >= 0; bush--) {
            const at = projection.at(run.cellCentre(run.bushCells[bush]));
            if (!this.isNear(at, projection.cellSide)) continue;
            const kind = run.kinds[bush];
            const variant = scatter(run.cell(run.bushCells[bush])) % VARIANTS;
            this.stamp(context, at, `${kind} ${variant}`, (on, place, side) => {
                const mirrored = variant % 2 === 0 ? side : -side;
                this.drawLeaning(on, this.sprites[names[kind]], place, [mirrored, side], Math.floor(variant / 2) * 0.12 - 0.12);
            });
        }
    }

    // Lays down what `draw` draws about a place, drawn once for cells of one size.
    stamp(context, [x, y], name, draw) {
        const side = this.projection.cellSide;
        if (side > MAX_STAMP) {
            draw(context, [x, y], side);
            return;
        }
        const half = Math.ceil(0.5 * STAMP_WIDTH * side) + 1;
        let stamp = this.stamps.get(name);
        if (stamp === undefined) {
            stamp = document.createElement("canvas");
            Object.assign(stamp, { width: 2 * half, height: 2 * half });
            draw(stamp.getContext("2d"), [half, half], side);
            this.stamps.set(name, stamp);
        }
        context.drawImage(stamp, Math.round(x) - half, Math.round(y) - half);
    }

    drawFlames() {
        const { run, context, projection, ns } = this;
        const side = projection.cellSide;
        if (side < MIN_SPRITE) return;
        const ages = [];
        for (let bush = run.kinds.length - 1; bush >= 0; bush--) {
            if (run.kinds[bush] !== BURNING) continue;
            const at = projection.at(run.cellCentre(run.bushCells[bush]));
            if (!this.isNear(at, side)) continue;
            const age = (ns - run.since[bush]) / NANOS;
            const offset = scatter(run.cell(run.bushCells[bush]));
            const frame = (Math.floor((ns / NANOS) * FRAMES_PER_SECOND) + offset) % FIRE_FRAMES;
            const isMirrored = Math.floor(offset / FIRE_FRAMES) % 2 === 0;
            const size = Math.min(Math.floor((age / GROWS_FOR_S) * (FIRE_SIZES - 1)), FIRE_SIZES - 1);
            const grown = SMALLEST_FIRE + ((1 - SMALLEST_FIRE) * size) / (FIRE_SIZES - 1);
            this.stamp(context, at, `fire ${frame} ${size} ${isMirrored}`, (on, place, cell) => {
                this.drawTongues(on, place, [grown * (isMirrored ? -cell : cell), grown * cell], frame);
            });
            if (this.shows("ages") && side >= MIN_AGE) ages.push([at, age]);
        }
        // Over all flames, since those of the cell in front would hide them.
        ages.forEach(([at, age]) => this.drawAge(at, side, age));
    }

    drawTongues(context, [x, y], [across, up], frame) {
        TONGUES.forEach(([right, above, height], index) => {
            const stretch = STRETCH[(frame + 3 * index) % FIRE_FRAMES];
            const lean = LEAN[(frame + 5 * index) % FIRE_FRAMES];
            const scale = [0.95 * height * across, height * (1 + stretch) * up];
            this.drawLeaning(context, this.sprites.flame, [x + right * across, y - above * up], scale, lean);
        });
    }

    drawAge([x, y], side, age) {
        const height = clamp(0.24 * side, 7, 18);
        const label = `${Math.floor(age)}`;
        const base = y + 0.46 * side;
        this.context.font = this.font(height);
        const half = 0.5 * this.context.measureText(label).width + 0.35 * height;
        this.context.fillStyle = css(rgb(this.colours.ink), 0.72);
        this.context.fillRect(x - half, base - 1.35 * height, 2 * half, 1.7 * height);
        this.write(label, [x, base], "center", height, this.colours.paper);
    }

    drawSpreads() {
        const { run, projection, unit, context } = this;
        const burning = rgb(this.colours.burning);
        for (const spread of run.spreadsBetween(Math.max(0, this.ns - RING_LASTS_NS), this.ns)) {
            const left = 1 - (this.ns - spread.time_ns) / RING_LASTS_NS;
            const from = run.cellCentre(spread.from);
            const centre = projection.at(from);
            const away = (cell) => Math.hypot(run.cellCentre(cell).x - from.x, run.cellCentre(cell).y - from.y);
            const reach = run.spread_radius_m ?? Math.max(0, ...spread.caught.map(away));
            const radius = reach * projection.scale * (1 - left * left);
            for (const [behind, width] of [[0.85, 1.5 * unit], [1, 3 * unit]]) {
                this.ring(context, centre, behind * radius, css(burning, left), width);
            }
            context.globalAlpha = 0.8 * left;
            spread.caught.forEach((cell) => {
                this.line(context, [centre, projection.at(run.cellCentre(cell))], SPREAD_LINE, 1.6 * unit);
            });
            context.globalAlpha = 1;
        }
    }

    // Outlines bushes whose state differs from that in the other run; on fields with other bushes none.
    drawDifferences() {
        const { run, rival, projection, context } = this;
        if (rival === null || run.cols !== rival.cols || run.kinds.length !== rival.kinds.length) return;
        this.sameBushes ??= run.bushCells.every((cell, bush) => cell === rival.bushCells[bush]) && run.cell_m === rival.cell_m;
        if (!this.sameBushes) return;
        const differing = new Set();
        run.kinds.forEach((kind, bush) => {
            if (kind !== rival.kinds[bush]) differing.add(run.bushCells[bush]);
        });
        const width = Math.max(0.1 * projection.cellSide, 1.5 * this.unit);
        const casing = Math.max(0.3 * width, 0.75 * this.unit);
        for (const [from, to, colour] of [[-casing, width + casing, this.colours.ink], [0, width, DIFFERENT]]) {
            context.fillStyle = colour;
            for (const cell of differing) {
                const { col, row } = run.cell(cell);
                const [left, top, right, bottom] = projection.cell({ col, row });
                const has = (cols, rows) => {
                    const isInside = col + cols >= 0 && col + cols < run.cols;
                    return isInside && differing.has(cell + cols + rows * run.cols);
                };
                const [across, down] = [right - left + 2 * to, bottom - top + 2 * to];
                if (!has(1, 0)) context.fillRect(right + from, top - to, to - from, down);
                if (!has(-1, 0)) context.fillRect(left - to, top - to, to - from, down);
                if (!has(0, 1)) context.fillRect(left - to, top - to, across, to - from);
                if (!has(0, -1)) context.fillRect(left - to, bottom + from, across, to - from);
            }
        }
    }

    drawWays() {
        this.run.agents.forEach((agent, index) => {
            this.drawDriven(agent);
            this.drawPlanned(agent, this.states[index]);
        });
    }

    // The oldest part first, each step of age more faded.
    drawDriven(agent) {
        const colour = rgb(this.colourOf(agent));
        const count = this.hasMarks ? MARKED_FADING_STEPS : FADING_STEPS;
        for (let step = count - 1; step >= 0; step--) {
            const ago = (steps) => Math.max(0, this.ns - (FADES_IN_NS / count) * steps);
            const [from, to] = [ago(step + 1), ago(step)];
            const ink = css(colour, FRESH + ((STALE - FRESH) * step) / (count - 1));
            for (let index = lastAt(agent.legTimes, to); index >= 0; index--) {
                const leg = agent.legs[index];
                const until = index + 1 < agent.legs.length ? agent.legTimes[index + 1] : Infinity;
                if (until < from) break;
                const window = [leg.distance(Math.max(from, leg.fromNs)), leg.distance(Math.min(to, until))];
                for (const stretch of this.stretches(leg, window)) {
                    this.drawStretch(stretch, ink, 2 * this.unit, stretch.isReverse ? REVERSE : null);
                }
            }
        }
    }

    // Dashes stay where they are on the ground while the agent comes along.
    drawPlanned(agent, state) {
        const { unit, colours } = this;
        if (state.goal >= 0) this.drawGoal(state.goal, agent);
        if (state.leg === null) return;
        const window = [state.leg.distance(this.ns), state.leg.lengthM];
        for (const stretch of this.stretches(state.leg, window)) {
            if (this.hasMarks) {
                this.drawStretch(stretch, css(rgb(this.colourOf(agent)), agent.is_truck ? 0.9 : 0.35), unit, [4, 3]);
                continue;
            }
            this.drawStretch(stretch, css(rgb(colours.paper), 0.75), 4 * unit, null);
            this.drawStretch(stretch, this.colourOf(agent), 2 * unit, stretch.isReverse ? REVERSE : FORWARD);
        }
    }

    drawGoal(cell, agent) {
        const { unit, context, colours, projection } = this;
        const [x, y] = projection.at(this.run.cellCentre(cell));
        if (this.hasMarks) {
            context.strokeStyle = css(rgb(this.colourOf(agent)), agent.is_truck ? 0.9 : 0.35);
            context.lineWidth = unit;
            context.strokeRect(x - 3 * unit, y - 3 * unit, 6 * unit, 6 * unit);
            return;
        }
        const half = Math.max(0.62 * projection.cellSide, 6 * unit);
        const arm = 0.6 * half;
        for (const [right, down] of [[1, 1], [1, -1], [-1, 1], [-1, -1]]) {
            const corner = [x + right * half, y + down * half];
            const bracket = [[corner[0] - right * arm, corner[1]], corner, [corner[0], corner[1] - down * arm]];
            this.line(context, bracket, colours.paper, 4 * unit);
            this.line(context, bracket, this.colourOf(agent), 2 * unit);
        }
    }

    // The part of a leg between two distances from its beginning, cut where the agent changes between forward and reverse.
    stretches(leg, [fromM, toM]) {
        const stretches = [];
        for (const piece of leg.pieces) {
            if (piece.kind !== DRIVE) continue;
            const length = Math.abs(piece.lengthM);
            const [first, last] = [Math.max(fromM - piece.beginsM, 0), Math.min(toM - piece.beginsM, length)];
            if (first >= last) continue;
            const isReverse = piece.lengthM < 0;
            const place = (metres) => along(piece.start, piece.curvature, isReverse ? -metres : metres);
            let stretch = stretches[stretches.length - 1];
            if (stretch === undefined || stretch.isReverse !== isReverse) {
                stretch = { isReverse, fromM: piece.beginsM + first, points: [place(first)] };
                stretches.push(stretch);
            }
            const turn = Math.abs(piece.curvature * (last - first));
            const radius = this.projection.scale / Math.abs(piece.curvature);
            const arcs = turn === 0 ? 1 : clamp(Math.ceil(turn * Math.sqrt(radius / (8 * ARC_TOLERANCE))), 1, 2000);
            stretch.toM = piece.beginsM + last;
            for (let arc = 1; arc <= arcs; arc++) stretch.points.push(place(first + ((last - first) * arc) / arcs));
        }
        return stretches;
    }

    drawStretch(stretch, ink, width, dashes) {
        const { context } = this;
        const isEndless = (stretch.toM - stretch.fromM) * this.projection.scale > MAX_DASHED;
        if (dashes !== null && !isEndless) {
            context.setLineDash(dashes.map((length) => length * this.unit));
            context.lineDashOffset = stretch.fromM * this.projection.scale;
        }
        this.line(context, stretch.points.map((point) => this.projection.at(point)), ink, width);
        context.setLineDash([]);
    }

    // Reach, jet and progress of every truck that suppresses.
    drawSuppressions() {
        const { run, context, projection, unit, colours } = this;
        run.agents.forEach((agent, index) => {
            const state = this.states[index];
            const stop = state.activity === SUPPRESSING && agent.is_truck ? agent.stopAt(this.ns) : null;
            if (stop === null) return;
            const from = agent.centre(state);
            const [centre, cell] = [projection.at(from), run.cellCentre(stop.cell)];
            if (run.reach_m !== null) {
                const reach = run.reach_m * projection.scale;
                this.disc(context, centre, reach, css(rgb(colours.water), 0.1));
                this.ring(context, centre, reach, css(rgb(colours.water), 0.8), 1.5 * unit);
            }
            const short = Math.min(1, (0.4 * run.cell_m) / Math.hypot(cell.x - from.x, cell.y - from.y));
            const nozzle = { x: cell.x - (cell.x - from.x) * short, y: cell.y - (cell.y - from.y) * short };
            const jet = [centre, projection.at(nozzle)];
            const width = Math.max(0.4 * projection.scale, 2 * unit);
            this.line(context, jet, colours.water, width + 2);
            this.line(context, jet, colours.extinguished, width);
            context.setLineDash([7, 7]);
            context.lineDashOffset = 14 - (((this.ns / NANOS) * 60) % 14);
            this.line(context, jet, colours.paper, width);
            context.setLineDash([]);
            this.drawProgress(projection.at(cell), clamp((this.ns - stop.sinceNs) / stop.lastsNs, 0, 1));
        });
    }

    // A ring that fills clockwise from the top.
    drawProgress(at, share) {
        const { context, unit, colours } = this;
        const radius = clamp(0.8 * this.projection.cellSide, 9 * unit, 60 * unit);
        const width = Math.max(0.2 * radius, 3.5);
        this.ring(context, at, radius, colours.ink, width + 2);
        this.ring(context, at, radius, colours.paper, width);
        context.beginPath();
        context.arc(...at, radius, -0.25 * TAU, (share - 0.25) * TAU);
        context.strokeStyle = colours.water;
        context.lineWidth = width;
        context.stroke();
    }

    // Pixels from end to end of a body, or its mark, as it is drawn.
    drawnLength(agent) {
        if (this.hasMarks) return this.unit * (agent.is_truck ? MARK_LENGTH : 2 * MARK_RADIUS);
        const least = (agent.is_truck ? MIN_UNIMOG : MIN_WUMPUS) * this.unit;
        return Math.max(agent.lengthM * this.projection.scale, least);
    }

    drawAgent(index) {
        const { context, unit, colours } = this;
        const [agent, state] = [this.run.agents[index], this.states[index]];
        const at = this.projection.at(agent.centre(state));
        const length = this.drawnLength(agent);
        if (!this.isNear(at, length)) return;
        if (length > agent.lengthM * this.projection.scale) {
            const radius = 0.62 * length + 2 * unit;
            this.ring(context, at, radius, colours.paper, 4 * unit);
            this.ring(context, at, radius, this.colourOf(agent), 2 * unit);
        }
        if (agent.is_truck) this.drawTruck(agent, state, at, length);
        else this.drawTurned(context, this.sprites.wumpus, at, state.heading, [length, length]);
        const isOneOfMany = this.run.agents.filter((other) => other.is_truck === agent.is_truck).length > 1;
        if (isOneOfMany && !this.isCrowded) this.drawNumber(agent, at, length);
    }

    drawTruck(agent, state, [x, y], length) {
        const [lengthM, widthM, wheelbaseM, offsetM] = agent.body_m;
        const scale = length / lengthM;
        const drawn = [(lengthM / DRAWN_TRUCK_M[0]) * scale, (widthM / DRAWN_TRUCK_M[1]) * scale];
        const steering = Math.atan(wheelbaseM * (state.leg === null ? 0 : state.leg.curvatureAt(this.ns)));
        const [sin, cos] = [Math.sin(state.heading), Math.cos(state.heading)];
        for (const [forwardM, angle] of [[-offsetM, 0], [wheelbaseM - offsetM, steering]]) {
            for (const side of [-0.5, 0.5]) {
                const [forward, left] = [forwardM * scale, side * WHEEL_AT * widthM * scale];
                const hub = [x + forward * cos - left * sin, y - forward * sin - left * cos];
                this.drawTurned(this.context, this.sprites.wheel, hub, state.heading + angle, drawn);
            }
        }
        this.drawTurned(this.context, this.sprites.unimog, [x, y], state.heading, drawn);
    }

    // A truck as an arrow, a Wumpus as a disc, hollow while it does nothing.
    drawMark(agent, state, [x, y]) {
        const { context, unit, colours } = this;
        const isIdle = state.activity === STANDING;
        if (!agent.is_truck) {
            const radius = MARK_RADIUS * unit;
            this.disc(context, [x, y], radius + MARK_EDGE * unit, colours.paper);
            this.disc(context, [x, y], radius, this.colourOf(agent));
            if (isIdle) this.disc(context, [x, y], 0.55 * radius, colours.paper);
            return;
        }
        const [sin, cos] = [Math.sin(state.heading), Math.cos(state.heading)];
        const arrow = (length) => [[0.58, 0], [-0.42, 0.36], [-0.24, 0], [-0.42, -0.36]].map(([forward, left]) => {
            return [x + length * (forward * cos - left * sin), y - length * (forward * sin + left * cos)];
        });
        const length = MARK_LENGTH * unit;
        this.area(context, arrow(length + 4 * MARK_EDGE * unit), colours.paper);
        this.area(context, arrow(length), this.colourOf(agent));
        if (isIdle) this.area(context, arrow(0.5 * length), colours.paper);
    }

    drawNumber(agent, [x, y], length) {
        const { context, unit } = this;
        const at = [x + 0.45 * length + 4 * unit, y - 0.45 * length];
        context.font = this.font(8 * unit);
        const width = context.measureText(`${agent.number}`).width;
        context.fillStyle = this.colourOf(agent);
        context.fillRect(at[0] - 2 * unit, at[1] - 10 * unit, width + 4 * unit, 12 * unit);
        this.write(`${agent.number}`, at, "left", 8 * unit, this.colours.paper);
    }

    drawSelected() {
        const { view, context, unit, colours, projection } = this;
        const selected = view.selected;
        if (selected === null || selected.run !== this.runIndex) return;
        if (selected.bush !== null) {
            const [x, y] = projection.at(this.run.cellCentre(this.run.bushCells[selected.bush]));
            const half = 0.5 * projection.cellSide + 4 * unit;
            for (const [width, colour] of [[6 * unit, colours.paper], [3 * unit, colours.ink]]) {
                context.strokeStyle = colour;
                context.lineWidth = width;
                context.lineJoin = "round";
                context.strokeRect(x - half, y - half, 2 * half, 2 * half);
            }
        } else {
            const agent = this.run.agents[selected.agent];
            const at = projection.at(agent.centre(this.states[selected.agent]));
            const radius = 0.6 * this.drawnLength(agent) + 7 * unit;
            this.ring(context, at, radius, colours.paper, 6 * unit);
            this.ring(context, at, radius, colours.ink, 3 * unit);
        }
    }

    // A bar of a round length, at the lower left.
    drawLengthBar() {
        const { context, unit, colours, canvas } = this;
        const [margin, text, padding] = [10 * unit, 8 * unit, 6 * unit];
        const longest = Math.min(140 * unit, 0.3 * canvas.width) / this.projection.scale;
        const power = 10 ** Math.floor(Math.log10(longest));
        const metres = [5, 2, 1].find((factor) => factor * power <= longest) * power;
        const length = metres * this.projection.scale;
        const label = metres < 1000 ? `${metres} m` : `${metres / 1000} km`;
        context.font = this.font(text);
        const width = Math.max(length, context.measureText(label).width);
        const bottom = canvas.height - margin;
        const height = text + 3 * padding;
        context.fillStyle = css(rgb(colours.paper), 0.85);
        context.fillRect(margin, bottom - height, width + 2 * padding, height);
        const [left, line] = [margin + padding, bottom - padding];
        this.write(label, [left, line - padding - unit], "left", text, colours.ink);
        const rect = (x, y, across, down) => context.fillRect(...[x, y, across, down].map(Math.round));
        rect(left, line - 2 * unit, length, 2 * unit);
        for (const end of [left, left + length - 2 * unit]) rect(end, line - 5 * unit, 2 * unit, 5 * unit);
    }

    // The object drawn at a place: the nearest agent, if its body is within a few pixels, otherwise a bush.
    // Rings around cells marked by a host, with a bold one around the selected cell.
    drawMarked() {
        const { context, projection, unit, run, view } = this;
        const { cells, pointedAt } = view.marked;
        const radius = Math.max(0.5 * projection.cellSide, 4 * unit);
        context.setTransform(1, 0, 0, 1, 0, 0);
        for (const cell of cells) {
            const [x, y] = projection.at(run.cellCentre(cell));
            const isPointedAt = cell === pointedAt;
            context.beginPath();
            context.arc(x, y, isPointedAt ? 1.6 * radius : radius, 0, 2 * Math.PI);
            // A light rim makes rings visible on any background.
            for (const [colour, width] of [["#ffffff", isPointedAt ? 6 : 3], [MARKED, isPointedAt ? 3.5 : 1.5]]) {
                Object.assign(context, { strokeStyle: colour, lineWidth: width * unit });
                context.stroke();
            }
        }
    }

    // The cell at a place of the canvas; null outside the field.
    cellAt(place) {
        return this.run.cellAt(this.projection.world(place));
    }

    pick([x, y]) {
        let [best, nearest] = [null, Infinity];
        this.run.agents.forEach((agent, index) => {
            const [agentX, agentY] = this.projection.at(agent.centre(this.states[index]));
            const distance = Math.hypot(x - agentX, y - agentY);
            if (distance <= 0.5 * this.drawnLength(agent) + 6 * this.view.pixelRatio && distance < nearest) {
                [best, nearest] = [{ run: this.runIndex, bush: null, agent: index }, distance];
            }
        });
        if (best !== null) return best;
        const bush = this.run.bushOfCell.get(this.run.cellAt(this.projection.world([x, y])));
        return bush === undefined ? null : { run: this.runIndex, bush, agent: null };
    }

    isNear([x, y], reach) {
        return x >= -reach && y >= -reach && x <= this.canvas.width + reach && y <= this.canvas.height + reach;
    }

    // Of letters whose capitals are so many pixels high.
    font(height, isBold = false) {
        return `${isBold ? "bold " : ""}${height * EM}px ${FONT}`;
    }

    write(text, [x, y], align, height, colour, isBold = false) {
        const { context } = this;
        context.font = this.font(height, isBold);
        context.textAlign = "left";
        context.fillStyle = colour;
        // A line begins at a whole pixel, as in pictures.
        const left = align === "left" ? x : x - 0.5 * context.measureText(text).width;
        context.fillText(text, Math.round(left), Math.round(y));
    }

    drawLeaning(context, sprite, [x, y], [across, up], lean) {
        this.drawSprite(context, sprite, [across, 0, lean * across, -up, x, y]);
    }

    drawTurned(context, sprite, [x, y], heading, [forward, left]) {
        const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
        this.drawSprite(context, sprite, [forward * cos, -forward * sin, -left * sin, -left * cos, x, y]);
    }

    drawSprite(context, sprite, transform) {
        context.setTransform(...transform);
        context.lineCap = "round";
        context.lineJoin = "round";
        for (const { colour, width, path } of sprite) {
            if (width > 0) {
                context.strokeStyle = colour;
                context.lineWidth = width;
                context.stroke(path);
            } else {
                context.fillStyle = colour;
                context.fill(path);
            }
        }
        context.lineCap = "butt";
        context.setTransform(1, 0, 0, 1, 0, 0);
    }

    line(context, points, colour, width) {
        context.beginPath();
        points.forEach((point, index) => (index === 0 ? context.moveTo(...point) : context.lineTo(...point)));
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.lineJoin = "round";
        context.stroke();
    }

    area(context, corners, colour) {
        context.beginPath();
        corners.forEach((point, index) => (index === 0 ? context.moveTo(...point) : context.lineTo(...point)));
        context.fillStyle = colour;
        context.fill();
    }

    disc(context, at, radius, colour) {
        context.beginPath();
        context.arc(...at, Math.max(0, radius), 0, TAU);
        context.fillStyle = colour;
        context.fill();
    }

    ring(context, at, radius, colour, width) {
        context.beginPath();
        context.arc(...at, Math.max(0, radius), 0, TAU);
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.stroke();
    }
}

// Bushes that fire has changed count so many times where cells are smaller than pixels, since they are what one looks for.
const EMPHASIS = 4;

// Sides of the squares in which agents and fires count as close together; half a mark of one agent and the radius of the glow
// of one bush, with what twice as many add; opacity of a glow, share of its core, and opacity of that; where bushes take more than a
// share of a square, there is no glow.
const AGENT_SQUARE = 56;
const FIRE_SQUARE = 12;
const HALF_CLUSTER = [6, 1.6];
const GLOW = [5, 1.6];
const [OPACITY, CORE, CORE_OPACITY] = [0.45, 0.5, 0.9];
const SEEN = 0.1;

Object.assign(FieldPane.prototype, {
    // Every pixel has the colour of the bushes that it covers, by shares, and the paler where they are few. A loop over numbers,
    // since it goes through all pixels.
    drawShares(context) {
        const { run, projection } = this;
        const { width, height } = this.canvas;
        const colours = this.stateColours.map(rgb);
        const side = projection.cellSide;
        // Of each pixel the sums of weights, and of weights times red, green and blue.
        const mixed = new Float32Array(4 * width * height);
        for (let bush = 0; bush < run.kinds.length; bush++) {
            const cell = run.bushCells[bush];
            const row = Math.floor(cell / run.cols);
            const left = projection.left + (cell - row * run.cols) * side;
            const bottom = projection.top - row * side;
            const [right, top] = [left + side, bottom - side];
            if (right <= 0 || bottom <= 0 || left >= width || top >= height) continue;
            const kind = run.kinds[bush];
            const [red, green, blue] = colours[kind];
            const weight = kind === INTACT ? 1 : EMPHASIS;
            const [lastX, lastY] = [Math.min(width, Math.ceil(right)), Math.min(height, Math.ceil(bottom))];
            for (let y = Math.max(0, Math.floor(top)); y < lastY; y++) {
                const down = weight * (Math.min(bottom, y + 1) - Math.max(top, y));
                for (let x = Math.max(0, Math.floor(left)); x < lastX; x++) {
                    const share = down * (Math.min(right, x + 1) - Math.max(left, x));
                    const at = 4 * (y * width + x);
                    mixed[at] += share * red;
                    mixed[at + 1] += share * green;
                    mixed[at + 2] += share * blue;
                    mixed[at + 3] += share;
                }
            }
        }
        const picture = context.getImageData(0, 0, width, height);
        const pixels = picture.data;
        for (let at = 0; at < pixels.length; at += 4) {
            const all = mixed[at + 3];
            if (all < 1e-4) continue;
            const opacity = Math.min(all, 1);
            for (let channel = at; channel < at + 3; channel++) {
                pixels[channel] += (mixed[channel] / all - pixels[channel]) * opacity;
            }
        }
        context.putImageData(picture, 0, 0);
    },

    // The squares of a lattice that is fixed to the field, by rows and columns: the mean of the places in each, and what is there.
    // The lattice is shifted by a share of a square.
    clusters(square, shift, places) {
        const side = square * this.unit;
        const squares = new Map();
        for (const [point, what] of places) {
            const [x, y] = this.projection.at(point);
            const [col, row] = [x - this.projection.left, y - this.projection.top].map((at) => Math.floor(at / side + shift));
            const key = row * 65536 + col;
            const known = squares.get(key) ?? { x: 0, y: 0, there: [] };
            squares.set(key, { x: known.x + x, y: known.y + y, there: known.there });
            known.there.push(what);
        }
        const ordered = [...squares].sort(([one], [other]) => one - other);
        return ordered.map(([, { x, y, there }]) => ({ at: [x / there.length, y / there.length], there }));
    },

    // Agents as marks, several close together as one with their number: trucks as a square, Wumpuses as a disc.
    drawMarks() {
        const { run, unit, context, colours } = this;
        for (const isTruck of [false, true]) {
            const agents = run.agents.flatMap((agent, index) => {
                return agent.is_truck === isTruck ? [[agent.centre(this.states[index]), index]] : [];
            });
            for (const { at, there } of this.clusters(AGENT_SQUARE, isTruck ? 0 : 0.5, agents)) {
                if (there.length === 1) {
                    this.drawMark(run.agents[there[0]], this.states[there[0]], at);
                    continue;
                }
                const half = (HALF_CLUSTER[0] + HALF_CLUSTER[1] * (31 - Math.clz32(there.length))) * unit;
                for (const [reach, colour] of [[half + MARK_EDGE * unit, colours.paper], [half, this.colourOf(run.agents[there[0]])]]) {
                    context.fillStyle = colour;
                    if (isTruck) context.fillRect(at[0] - reach, at[1] - reach, 2 * reach, 2 * reach);
                    else this.disc(context, at, 1.1 * reach, colour);
                }
                this.write(`${there.length}`, [at[0], at[1] + 4 * unit], "center", 8 * unit, colours.paper, true);
            }
        }
    },

    // A glow about bushes close together that fire has changed, whose core has the mean colour of their states.
    drawGlows() {
        const { run, projection, unit, context } = this;
        const colours = this.stateColours.map(rgb);
        const changed = [];
        run.kinds.forEach((kind, bush) => {
            if (kind !== INTACT) changed.push([run.cellCentre(run.bushCells[bush]), kind]);
        });
        const most = SEEN * ((FIRE_SQUARE * unit) / projection.cellSide) ** 2;
        for (const { at, there } of this.clusters(FIRE_SQUARE, 0, changed)) {
            const radius = (GLOW[0] + GLOW[1] * (31 - Math.clz32(there.length))) * unit;
            if (there.length >= most || !this.isNear(at, radius)) continue;
            const weighted = there.flatMap((kind) => (kind === BURNING ? Array(EMPHASIS).fill(kind) : [kind]));
            const mean = [0, 1, 2].map((channel) => Math.floor(weighted.reduce((sum, kind) => sum + colours[kind][channel], 0) / weighted.length));
            this.disc(context, at, radius, css(rgb(this.colours.burning), OPACITY));
            this.disc(context, at, CORE * radius, css(mean, CORE_OPACITY));
        }
    },

    // Marks burning cells that are too small to see; `half` thin lines from the centre of a mark to its sides.
    drawFireMarks(half) {
        const { run, projection, unit, context, colours } = this;
        const edges = half > 1 ? [[half + 1, colours.ink], [half, colours.burning]] : [[half, colours.burning]];
        for (const [reach, colour] of edges) {
            const side = Math.max(reach * unit, 0.5 * projection.cellSide);
            context.fillStyle = colour;
            run.kinds.forEach((kind, bush) => {
                if (kind !== BURNING) return;
                const [x, y] = projection.at(run.cellCentre(run.bushCells[bush]));
                if (!this.isNear([x, y], side)) return;
                const [left, top] = [Math.round(x - side), Math.round(y - side)];
                context.fillRect(left, top, Math.round(x + side) - left, Math.round(y + side) - top);
            });
        }
    },

    // Numbers of agents that are many: each at the upper right of its agent where nothing else is, or nowhere; of marks only those
    // that the viewer asked about.
    drawLabels() {
        const { run, projection, unit, context, canvas, view } = this;
        const taken = [[0, canvas.height - 36 * unit, 162 * unit, 36 * unit]];
        const about = ([x, y], half) => [x - half, y - half, 2 * half, 2 * half];
        const fire = Math.max(0.5 * projection.cellSide, 2 * unit);
        run.kinds.forEach((kind, bush) => {
            if (kind === BURNING) taken.push(about(projection.at(run.cellCentre(run.bushCells[bush])), fire));
        });
        const shown = run.agents.flatMap((agent, index) => {
            const [at, length] = [projection.at(agent.centre(this.states[index])), this.drawnLength(agent)];
            const isLarger = !this.hasMarks && length > agent.lengthM * projection.scale;
            const reach = isLarger ? 0.62 * length + 4 * unit : 0.5 * length + unit;
            if (!this.isNear(at, reach)) return [];
            taken.push(about(at, 0.75 * reach));
            const isAsked = view.follows === agent.id || (view.selected?.run === this.runIndex && view.selected.agent === index);
            if (this.hasMarks && !isAsked) return [];
            const isIdle = this.states[index].activity === STANDING;
            const turn = isAsked ? 0 : !agent.is_truck ? 3 : isIdle ? 2 : 1;
            return [{ agent, at, reach: reach + unit, turn }];
        });
        shown.sort((one, other) => one.turn - other.turn);
        const overlap = (one, other) =>
            one[0] < other[0] + other[2] && other[0] < one[0] + one[2] && one[1] < other[1] + other[3] && other[1] < one[1] + one[3];
        for (const { agent, at, reach } of shown) {
            context.font = this.font(8 * unit, true);
            const [width, height] = [context.measureText(`${agent.number}`).width + 4 * unit, 12 * unit];
            const box = [at[0] + 0.75 * reach, at[1] - 0.75 * reach - height, width, height];
            const isInside = box[0] >= 0 && box[1] >= 0 && box[0] + width <= canvas.width && box[1] + height <= canvas.height;
            if (!isInside || taken.some((other) => overlap(box, other))) continue;
            taken.push(box);
            context.fillStyle = css(rgb(this.colours.paper), 0.8);
            context.fillRect(...box.map(Math.round));
            this.write(`${agent.number}`, [box[0] + 2 * unit, box[1] + height - 2 * unit], "left", 8 * unit, this.colourOf(agent), true);
        }
    },
});
