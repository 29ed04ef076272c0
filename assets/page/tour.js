// A guided tour of the first run: its field, its first fire, a truck and how it plans, the largest search, the closest
// moment, and the end.

// How long a stop of the tour plays, and how soon before its moment it begins, in seconds of the viewer.
const STOP_S = 7;
const LEAD_S = 2;
// What is seen around a fire, in metres.
const AROUND_M = 30;

class Tour {
    // Begins at the first stop; `player` is shown as before when the tour is over.
    constructor(player) {
        const { view, speed, ns } = player;
        this.player = player;
        this.before = { camera: view.camera, follows: view.follows, layers: new Set(view.layers), selected: view.selected, speed, ns };
        this.stops = stopsOf(player.runs[0], player.data);
        view.isOnTour = true;
        this.show(0);
    }

    show(index) {
        const { player, before } = this;
        const stop = this.stops[index];
        if (stop === undefined) return player.endTour();
        this.index = index;
        const [run] = player.runs;
        const { view } = player;
        view.layers = new Set([...before.layers, ...(stop.layers ?? [])]);
        view.selected = stop.selected ?? null;
        view.camera = { x: 0.5, y: 0.5, zoom: 1 };
        player.follow(stop.follows ?? null);
        if (stop.around !== undefined) {
            const { canvas } = player.panes[0];
            const { x, y } = stop.around;
            const box = { low: [x - AROUND_M, y - AROUND_M], high: [x + AROUND_M, y + AROUND_M] };
            view.camera = holding(run, box, canvas.width, canvas.height);
        }
        player.showLayers();
        player.setSpeed(stop.speed);
        player.seek(stop.ns - LEAD_S * stop.speed * NANOS);
        this.untilNs = Math.min(stop.ns + (STOP_S - LEAD_S) * stop.speed * NANOS, player.endNs);
        // Who wants no motion sees the moment itself, and goes on by hand.
        const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
        if (isStill || stop.ns >= player.endNs) player.seek(stop.ns);
        player.setPlaying(!isStill && stop.ns < player.endNs);
        player.showCaption(`${index + 1}/${this.stops.length} \u00b7 ${stop.text}`, index + 1 < this.stops.length ? "next" : "end the tour");
    }

    next() {
        this.show(this.index + 1);
    }

    // Whether the stop has been played, so that the next one follows.
    passes(ns) {
        return ns >= this.untilNs && this.index + 1 < this.stops.length;
    }

    // Restores the view of before, at the end of the run if the tour came there.
    restore() {
        const { player, before } = this;
        const { camera, layers, selected } = before;
        Object.assign(player.view, { camera, layers, selected, isOnTour: false });
        player.setPlaying(false);
        player.setSpeed(before.speed);
        player.follow(before.follows);
        player.showLayers();
        if (this.index + 1 < this.stops.length) player.seek(before.ns);
    }
}

// The stops that a run has: a text, a time, a speed, and where to look.
function stopsOf(run, data) {
    const trucks = run.agents.filter(({ is_truck }) => is_truck);
    const whole = { ns: 0, speed: 10, text: openingText(run) };
    return [whole, firstFire(run), firstDrive(run, trucks), largestSearch(run, data), closestMoment(run), { ns: run.end_ns, speed: 10, text: `${run.verdict}.` }].filter((stop) => stop !== null);
}

function openingText(run) {
    const size = `${formatMetres(run.widthM)} by ${formatMetres(run.heightM)}`;
    return run.bushCells.length > 0 && !run.isOfGround ? `The whole field, ${size}, with ${run.bushCells.length} bushes.` : `The whole landscape, ${size}.`;
}

function firstFire(run) {
    const bush = run.changes.to.indexOf(BURNING);
    const ground = run.ground?.burnings[0];
    const [ns, cell] = bush >= 0 && !(ground?.ignitedNs < run.changes.times[bush])
        ? [run.changes.times[bush], run.bushCells[run.changes.bushes[bush]]]
        : [ground?.ignitedNs, ground?.cell];
    if (ns === undefined) return null;
    return { ns, speed: run.isOfGround ? 30 : 2, around: run.cellCentre(cell), text: `The first fire, ${formatClock(ns)} after the start.` };
}

// The first drive of a truck that takes a while.
function firstDrive(run, trucks) {
    const drives = trucks.flatMap((truck) => truck.legs.filter(({ lengthM }) => lengthM > 20).slice(0, 1).map(({ fromNs }) => ({ truck, ns: fromNs })));
    const [first] = drives.sort((one, other) => one.ns - other.ns);
    if (first === undefined) return null;
    const layers = run.hasSearches ? ["roadmap", "prm-query", "local-search"] : [];
    const lines = run.hasSearches ? " Lines show its roadmap, the search in it, and the local search around it." : "";
    return { ns: first.ns, speed: 5, follows: first.truck.id, layers, text: `${first.truck.id} sets out.${lines}` };
}

function largestSearch(run, data) {
    const isSearch = ({ style }) => data.search_styles[style].layer !== "roadmap";
    const [largest] = run.searches.filter(isSearch).sort((one, other) => other.edges.length - one.edges.length);
    if (largest === undefined) return null;
    const { layer } = data.search_styles[largest.style];
    const agent = run.agents[largest.agent];
    const text = `The largest search, by ${agent.id}: a ${LAYER_NAMES[layer] ?? layer} of ${largest.edges.length / 2} steps.`;
    return { ns: largest.time_ns, speed: 2, layers: [layer], selected: { run: 0, bush: null, agent: largest.agent }, text };
}

// The bush that was extinguished last before it would have burned out.
function closestMoment(run) {
    if (run.burn_out_ns === null) return null;
    const ignited = new Map();
    let closest = null;
    run.changes.times.forEach((ns, index) => {
        const bush = run.changes.bushes[index];
        if (run.changes.to[index] === BURNING) ignited.set(bush, ns);
        if (run.changes.to[index] !== EXTINGUISHED) return;
        const leftNs = ignited.get(bush) + run.burn_out_ns - ns;
        if (closest === null || leftNs < closest.leftNs) closest = { ns, bush, leftNs };
    });
    if (closest === null) return null;
    const { ns, bush, leftNs } = closest;
    const text = `The closest moment: extinguished ${(leftNs / NANOS).toFixed(1)} s before it would have burned out.`;
    return { ns, speed: 2, around: run.cellCentre(run.bushCells[bush]), selected: { run: 0, bush, agent: null }, text };
}
