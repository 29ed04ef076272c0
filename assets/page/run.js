// The state of a run at any time. The program provides the tables; motion is computed in closed form, as in the program.

"use strict";

const NANOS = 1e9;
const PER_METRE = 1e4;
const PER_RADIAN = 1e6;
const PER_CURVATURE = 1e8;
const PER_MPS = 1e6;

// Kinds of pieces of a leg.
const DRIVE = 0;
const TURN = 1;

// States of bushes.
const INTACT = 0;
const BURNING = 1;
const BURNED_OUT = 2;
const EXTINGUISHED = 3;

// Activities of agents.
const STANDING = 0;
const PLANNING = 1;
const DRIVING = 2;
const SUPPRESSING = 3;
const WAITING = 4;
const REFILLING = 5;

const DIRECTIONS = ["north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west"];

// Sums differences, each relative to the number `stride` places before.
function sums(differences, stride = 1) {
    const values = Float64Array.from(differences);
    for (let index = stride; index < values.length; index++) values[index] += values[index - stride];
    return values;
}

// The index of the last of ascending times that is not later than `time`; -1 before all of them.
function lastAt(times, time) {
    let [low, high] = [0, times.length];
    while (low < high) {
        const middle = (low + high) >> 1;
        if (times[middle] <= time) low = middle + 1;
        else high = middle;
    }
    return low - 1;
}

// The pose of a body after a number of metres along a curve; negative metres go backwards.
function along(pose, curvature, metres) {
    const heading = pose.heading + curvature * metres;
    if (curvature === 0) {
        const { x, y } = pose;
        return { x: x + metres * Math.cos(heading), y: y + metres * Math.sin(heading), heading };
    }
    const right = (Math.sin(heading) - Math.sin(pose.heading)) / curvature;
    const up = (Math.cos(pose.heading) - Math.cos(heading)) / curvature;
    return { x: pose.x + right, y: pose.y + up, heading };
}

// A leg: the start of a drive, and its pieces, each with its start pose and time.
class Leg {
    constructor(fromNs, startNs, drivenM, start, pieces) {
        Object.assign(this, { fromNs, startNs, drivenM, start, pieces });
        let [seconds, metres, pose] = [0, 0, start];
        for (const piece of pieces) {
            Object.assign(piece, { beginsS: seconds, beginsM: metres, start: pose });
            if (piece.kind === DRIVE) {
                metres += Math.abs(piece.lengthM);
                pose = along(pose, piece.curvature, piece.lengthM);
            } else if (piece.kind === TURN) {
                pose = { ...pose, heading: piece.heading };
            }
            seconds += piece.lastsS;
            piece.endsS = seconds;
        }
        this.lengthM = metres;
        this.end = pose;
        this.endNs = startNs + Math.ceil((seconds - 1e-11) * NANOS);
        // Metres driven on it before it was followed, for a leg that was cut short.
        this.beforeM = this.distance(fromNs);
    }

    // The current piece; none before the start and after the end.
    pieceAt(ns) {
        if (ns < this.startNs || ns >= this.endNs) return null;
        const seconds = (ns - this.startNs) / NANOS;
        return this.pieces.find((piece) => piece.endsS > seconds) ?? null;
    }

    coveredM(piece, ns) {
        const seconds = (ns - this.startNs) / NANOS - piece.beginsS;
        const covered = seconds * (piece.speed + 0.5 * piece.acceleration * seconds);
        return Math.min(Math.max(covered, 0), Math.abs(piece.lengthM));
    }

    // The pose and speed of the body.
    at(ns) {
        if (ns < this.startNs) return { ...this.start, speed: 0 };
        const piece = this.pieceAt(ns);
        if (piece === null) return { ...this.end, speed: 0 };
        if (piece.kind !== DRIVE) return { ...piece.start, speed: 0 };
        const seconds = (ns - this.startNs) / NANOS - piece.beginsS;
        const metres = Math.sign(piece.lengthM) * this.coveredM(piece, ns);
        const speed = Math.max(0, piece.speed + piece.acceleration * seconds);
        return { ...along(piece.start, piece.curvature, metres), speed };
    }

    // Metres driven so far, forward and in reverse.
    distance(ns) {
        if (ns < this.startNs) return 0;
        const piece = this.pieceAt(ns);
        if (piece === null) return this.lengthM;
        return piece.beginsM + (piece.kind === DRIVE ? this.coveredM(piece, ns) : 0);
    }

    // The current curvature of the wheels.
    curvatureAt(ns) {
        const drives = this.pieces.filter((piece) => piece.kind === DRIVE);
        if (drives.length === 0) return 0;
        if (ns >= this.endNs) return drives[drives.length - 1].curvature;
        const piece = this.pieceAt(ns);
        if (piece === null || piece === this.pieces[0]) return drives[0].curvature;
        return piece.kind === DRIVE ? piece.curvature : 0;
    }
}

class Agent {
    constructor(data) {
        Object.assign(this, data);
        const [x, y, heading] = data.start;
        this.start = { x: x / PER_METRE, y: y / PER_METRE, heading: heading / PER_RADIAN };
        this.legs = Agent.legs(data.legs);
        this.legTimes = Float64Array.from(this.legs, (leg) => leg.fromNs);
        const { time_ns, lasts_ns, cell } = data.stops;
        this.stops = { times: sums(time_ns), lasts: lasts_ns, cells: cell };
        const { activity, failure, ...columns } = data.steps;
        this.steps = { activity, failure };
        for (const [name, differences] of Object.entries(columns)) this.steps[name] = sums(differences);
        this.steps.spent = Agent.spent(this.steps);
    }

    static legs(table) {
        const [from, x, y, driven] = [table.from_ns, table.x, table.y, table.driven_m].map((column) => sums(column));
        let first = 0;
        return Array.from(from, (fromNs, index) => {
            const pieces = [];
            for (const last = first + table.pieces[index]; first < last; first++) {
                pieces.push(Agent.piece(table.piece, first));
            }
            const heading = table.heading[index] / PER_RADIAN;
            const start = { x: x[index] / PER_METRE, y: y[index] / PER_METRE, heading };
            return new Leg(fromNs, fromNs + table.wait_ns[index], driven[index] / PER_METRE, start, pieces);
        });
    }

    static piece(table, index) {
        const [kind, amount, lastsS] = [table.kind[index], table.amount[index], table.lasts[index] / 1e6];
        if (kind === TURN) return { kind, lastsS, heading: amount / PER_RADIAN };
        if (kind !== DRIVE) return { kind, lastsS };
        const speed = table.speed[index] / PER_MPS;
        const acceleration = table.acceleration[index] / PER_MPS;
        const curvature = table.curvature[index] / PER_CURVATURE;
        return { kind, lastsS, lengthM: amount / PER_METRE, curvature, speed, acceleration };
    }

    // Nanoseconds in each activity before each step.
    static spent(steps) {
        const spent = [new Float64Array(6)];
        for (let index = 1; index < steps.time_ns.length; index++) {
            const until = spent[index - 1].slice();
            until[steps.activity[index - 1]] += steps.time_ns[index] - steps.time_ns[index - 1];
            spent.push(until);
        }
        return spent;
    }

    legAt(ns) {
        return this.legs[lastAt(this.legTimes, ns)] ?? null;
    }

    // From the middle of the rear axle to that of the body.
    get offsetM() {
        return this.is_truck ? this.body_m[3] : 0;
    }

    get lengthM() {
        return this.body_m[0];
    }

    centre({ x, y, heading }) {
        return { x: x + this.offsetM * Math.cos(heading), y: y + this.offsetM * Math.sin(heading) };
    }

    at(ns) {
        const leg = this.legAt(ns);
        const pose = leg === null ? { ...this.start, speed: 0 } : leg.at(ns);
        const step = lastAt(this.steps.time_ns, ns);
        return { ...pose, leg, activity: this.steps.activity[step], goal: this.steps.goal[step] };
    }

    // The statistics so far.
    statsAt(ns) {
        const [step, leg] = [lastAt(this.steps.time_ns, ns), this.legAt(ns)];
        const spent = this.steps.spent[step].slice();
        spent[this.steps.activity[step]] += ns - this.steps.time_ns[step];
        const stats = { spent, failure: this.steps.failure[step] };
        for (const name of ["plans", "failures", "expansions", "cells"]) stats[name] = this.steps[name][step];
        stats.distanceM = leg === null ? 0 : leg.drivenM + leg.distance(ns) - leg.beforeM;
        return stats;
    }

    // The start of its suppression, and the cell.
    stopAt(ns) {
        const index = lastAt(this.stops.times, ns);
        if (index < 0) return null;
        const { times, lasts, cells } = this.stops;
        return { sinceNs: times[index], lastsNs: lasts[index], cell: cells[index] };
    }
}

class Run {
    constructor(data) {
        Object.assign(this, data);
        this.widthM = this.cols * this.cell_m;
        this.heightM = this.rows * this.cell_m;
        this.bushCells = sums(data.bush_cells);
        this.bushOfCell = new Map(Array.from(this.bushCells, (cell, bush) => [cell, bush]));
        this.agents = data.agents.map((agent) => new Agent(agent));
        const { to, words, burned } = data.changes;
        this.changes = { times: sums(data.changes.time_ns), bushes: sums(data.changes.bush), to, words, burned };
        this.counts = { ...data.counts, times: sums(data.counts.time_ns), bushes: data.counts.bushes.map((kind) => sums(kind)) };
        this.failedPlans = sums(data.failed_plans_ns);
        this.verdicts = data.verdicts.map(([colour, times]) => [colour, sums(times)]);
        this.moments = sums(data.moments_ns);
        this.spreadTimes = Float64Array.from(this.spreads, (spread) => spread.time_ns);
        this.hasSearches = this.searches.length > 0;
        this.ground = data.ground === null ? null : new Ground(this, data.ground);
        this.kinds = new Uint8Array(this.bushCells.length);
        this.since = new Float64Array(this.bushCells.length);
        this.changed = 0;
    }

    // Whether ground burns and no arsonist lights bushes: such a run is told in hectares.
    get isOfGround() {
        return this.ground !== null && (this.bushCells.length === 0 || this.agents.every(({ is_truck }) => is_truck));
    }

    // Whether both sides take part.
    get isContest() {
        return [true, false].every((side) => this.agents.some(({ is_truck }) => is_truck === side));
    }

    // The result in one sentence.
    get verdict() {
        const { bushes, wumpus, truck } = this.countsAt(this.end_ns);
        const saved = `${bushes[INTACT] + bushes[EXTINGUISHED]} of ${this.bushCells.length} bushes saved`;
        if (this.isOfGround) {
            const { burned, burning } = this.ground.hectaresAt(this.end_ns);
            return `${formatHectares(burned)} burned${burning > 0 ? `, ${formatHectares(burning)} still on fire` : "; the fire is out"}`;
        }
        if (!this.isContest) return saved;
        if (wumpus === truck) return `A tie: ${saved}`;
        const [word, winner] = truck > wumpus ? ["truck", true] : ["Wumpus", false];
        const count = this.agents.filter(({ is_truck }) => is_truck === winner).length;
        const by = formatPoints(Math.abs(wumpus - truck));
        const plural = winner ? "s" : "es";
        return `The ${word}${count > 1 ? plural : ""} won by ${by} point${by === "1" ? "" : "s"}: ${saved}`;
    }

    // Moves the states of bushes to a time.
    seek(ns) {
        const until = lastAt(this.changes.times, ns) + 1;
        if (until < this.changed) {
            this.kinds.fill(INTACT);
            this.changed = 0;
        }
        for (; this.changed < until; this.changed++) {
            const bush = this.changes.bushes[this.changed];
            this.kinds[bush] = this.changes.to[this.changed];
            this.since[bush] = this.changes.times[this.changed];
        }
    }

    countsAt(ns) {
        const step = lastAt(this.counts.times, ns);
        const scores = { wumpus: this.counts.wumpus_score[step], truck: this.counts.truck_score[step] };
        return { bushes: this.counts.bushes.map((kind) => kind[step]), ...scores };
    }

    cell(index) {
        return { col: index % this.cols, row: Math.floor(index / this.cols) };
    }

    cellCentre(index) {
        const { col, row } = this.cell(index);
        return { x: (col + 0.5) * this.cell_m, y: (row + 0.5) * this.cell_m };
    }

    cellName(index) {
        const { col, row } = this.cell(index);
        return `(${col}, ${row})`;
    }

    // How far and in which direction a cell is from a point.
    wayTo(index, { x, y }) {
        const centre = this.cellCentre(index);
        const [east, north] = [centre.x - x, centre.y - y];
        const sector = (Math.round((Math.atan2(east, north) * 8) / TAU) + 8) % 8;
        return `${Math.hypot(east, north).toFixed(0)} m ${DIRECTIONS[sector]}`;
    }

    // The cell at a point of the world; null outside.
    cellAt({ x, y }) {
        const [col, row] = [Math.floor(x / this.cell_m), Math.floor(y / this.cell_m)];
        const isInside = col >= 0 && row >= 0 && col < this.cols && row < this.rows;
        return isInside ? row * this.cols + col : null;
    }

    // Spreads after one time up to another.
    spreadsBetween(fromNs, toNs) {
        return this.spreads.slice(lastAt(this.spreadTimes, fromNs) + 1, lastAt(this.spreadTimes, toNs) + 1);
    }

    // The last search of each agent in a style, up to a time.
    searchesAt(style, ns) {
        const last = new Map();
        for (const search of this.searches) {
            if (search.time_ns > ns) break;
            if (search.style === style) last.set(search.agent, search);
        }
        return [...last.values()];
    }

    isHopeless(bush, arrivesNs) {
        if (this.burn_out_ns === null || this.kinds[bush] !== BURNING) return false;
        return arrivesNs + this.dwell_ns > this.since[bush] + this.burn_out_ns;
    }
}
