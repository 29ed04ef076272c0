// A page that computes its runs: it queries the module, plays the run so far, and asks the user for decisions.

// The target time of a slice of a run in milliseconds, and the longest lead of the computation in seconds of playing.
const SLICE_MS = 120;
const AHEAD_S = 30;
// The first slice, in simulated nanoseconds.
const FIRST_SLICE_NS = 600 * NANOS;
const FIRST_GAME_SPEED = 20;
const MAX_CHOICES = 200;

// The module in a thread: one answer per request, in order.
class Module {
    constructor(compiled) {
        this.compiled = compiled;
        this.begin();
    }

    begin() {
        this.thread = new Worker(URL.createObjectURL(new Blob([document.getElementById("worker").textContent], { type: "text/javascript" })));
        this.thread.postMessage({ module: this.compiled });
        this.waiting = new Map();
        this.number = 0;
        this.thread.onmessage = ({ data }) => {
            const { done, fail } = this.waiting.get(data.number);
            this.waiting.delete(data.number);
            const answer = JSON.parse(data.answer);
            if (answer.error === undefined) return done(answer);
            if (answer.error.isFatal) this.restart();
            fail(Object.assign(new Error(answer.error.message), answer.error));
        };
    }

    // Abandons a module that has stopped or is busy with an outdated request.
    restart() {
        this.thread.terminate();
        this.waiting.forEach(({ fail }) => fail(Object.assign(new Error("the run was abandoned"), { isLeft: true })));
        this.begin();
    }

    ask(request) {
        const number = this.number++;
        return new Promise((done, fail) => {
            this.waiting.set(number, { done, fail });
            this.thread.postMessage({ number, request: JSON.stringify(request) });
        });
    }
}

// A game as the end of a link, and back.
async function packedGame(game) {
    const packed = new Blob([JSON.stringify(game)]).stream().pipeThrough(new CompressionStream("deflate-raw"));
    const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
    return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function unpackedGame(text) {
    const packed = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).json();
}

function save(name, content, type) {
    const link = Object.assign(element("a"), { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const byId = (id) => document.getElementById(id);

class Desk {
    constructor(module, catalogue) {
        Object.assign(this, { module, scenarios: catalogue.scenarios, round: 0 });
        this.emptyStage = byId("player").innerHTML;
        const option = (text, value = text) => Object.assign(element("option", text), { value });
        byId("scenario").append(...catalogue.scenarios.map(({ name }) => option(name)), option("your own text", ""));
        byId("planner").append(option("default", ""), ...catalogue.planners.map((name) => option(name)));
        byId("scenario").addEventListener("change", () => this.showText());
        byId("text").addEventListener("input", () => (byId("scenario").value = ""));
        byId("setup").addEventListener("submit", (event) => {
            event.preventDefault();
            this.start();
        });
        byId("another").addEventListener("click", () => {
            byId("seed").value = Number(byId("seed").value) + 1;
            this.start();
        });
        const fromField = (event) => event.target.matches("select, input, textarea");
        document.addEventListener("keydown", (event) => {
            if (byId("question").hidden || fromField(event) || event.ctrlKey || event.metaKey || event.altKey) return;
            const does = { "]": () => this.pointNext(1), "[": () => this.pointNext(-1), enter: () => this.go(), w: () => this.answer("wait"), p: () => this.decide() };
            const act = does[event.key.toLowerCase()];
            if (act === undefined || (event.key === "Enter" && event.target.matches("button, a, summary"))) return;
            event.preventDefault();
            act();
        });
        this.showText();
    }

    showText() {
        const known = this.scenarios.find(({ name }) => name === byId("scenario").value);
        if (known !== undefined) byId("text").value = known.text;
    }

    // The form's values, as a game without answers.
    written() {
        const name = byId("scenario").value;
        const planner = byId("planner").value;
        return {
            scenario: name === "" ? { text: byId("text").value } : { name },
            changes: planner === "" ? [] : [`unimog.planner=${planner}`],
            seed: Number(byId("seed").value),
            plays: byId("side").value === "" ? [] : byId("side").value.split(" "),
            answers: [],
        };
    }

    // Shows a game in the form.
    show({ scenario, changes = [], seed, plays }) {
        byId("scenario").value = scenario.name ?? "";
        if (scenario.text !== undefined) byId("text").value = scenario.text;
        this.showText();
        byId("seed").value = seed;
        byId("side").value = plays.join(" ");
        byId("planner").value = changes.find((change) => change.startsWith("unimog.planner="))?.slice("unimog.planner=".length) ?? "";
    }

    async start(game = this.written()) {
        const round = ++this.round;
        const isCurrent = () => round === this.round;
        if (this.isBusy) this.module.restart();
        this.isBusy = true;
        this.player?.close();
        Object.assign(this, { player: null, game, state: null, finished: null, asked: null, limitS: Number(byId("limit").value) || null });
        this.tell("");
        try {
            const { wildfire_game, ...given } = game;
            this.opened = await this.module.ask({ do: "open", ...given, searches: byId("searches").checked });
            await this.makeAhead(isCurrent);
        } catch (error) {
            if (isCurrent() && !error.isLeft) this.refuse(error);
        } finally {
            if (isCurrent()) this.isBusy = false;
        }
    }

    // Lets the module compute ahead: to the next question, to the end, or for a while.
    async makeAhead(isCurrent) {
        let slice = FIRST_SLICE_NS;
        let [taken, costMs] = [0, 0];
        do {
            const begin = performance.now();
            const state = await this.module.ask({ do: "advance", to_ns: (this.state?.now_ns ?? 0) + slice });
            if (!isCurrent()) return;
            this.state = state;
            const now = performance.now();
            slice *= Math.min(4, Math.max(0.25, SLICE_MS / Math.max(1, now - begin)));
            const stops = state.has_ended || state.asked.length > 0;
            // The transferred data grow with the run, so they are transferred rarely when expensive.
            if (!stops && this.player !== null && now - taken < 4 * costMs) continue;
            const page = await this.module.ask({ do: "page" });
            // Reading the transferred data and showing them each fit into a frame.
            if (this.player !== null) await new Promise(requestAnimationFrame);
            if (!isCurrent()) return;
            this.take(page);
            [taken, costMs] = [performance.now(), performance.now() - now];
            if (stops) break;
            while (isCurrent() && this.isFarAhead()) await new Promise(requestAnimationFrame);
        } while (isCurrent());
        if (!isCurrent()) return;
        if (this.state.has_ended) {
            this.finished = await this.module.ask({ do: "finish" });
            if (isCurrent()) this.reachesEnd();
            if (isCurrent()) await this.makeRivals(isCurrent);
        } else {
            this.reachesEnd();
        }
    }

    isFarAhead() {
        const { player } = this;
        return player.endNs - player.ns > Math.max(AHEAD_S * player.speed, 3600) * NANOS;
    }

    take(page) {
        if (this.player !== null) {
            const wasAtEnd = this.player.ns === this.player.endNs;
            this.player.take(page);
            if (wasAtEnd && !this.isStill) this.player.setPlaying(true);
            else if (this.isStill) this.player.seek(this.player.endNs);
            return;
        }
        byId("player").innerHTML = this.emptyStage;
        byId("player").hidden = false;
        byId("question").addEventListener("submit", (event) => {
            event.preventDefault();
            this.go();
        });
        byId("wait").addEventListener("click", () => this.answer("wait"));
        byId("decide").addEventListener("click", () => this.decide());
        byId("choices").addEventListener("change", () => this.pointAt(Number(byId("choices").value)));
        byId("recording").addEventListener("click", () => this.saveRecording());
        byId("game").addEventListener("click", () => save(`${this.finished.name}.json`, JSON.stringify(this.finished.game), "application/json"));
        byId("link").addEventListener("click", () => this.copyLink());
        this.player = new Player(page, { picks: (pane, at) => this.picks(pane, at), reachesEnd: () => this.reachesEnd() });
        window.wildfire = this.player;
        const title = `${this.opened.scenario}, seed ${this.game.seed}`;
        document.querySelector("h1").textContent = title;
        document.title = `${title} – wildfire`;
        // A player sees the events happen; with reduced motion, only their result.
        this.isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
        if (this.game.plays.length > 0) this.player.setSpeed(FIRST_GAME_SPEED);
        if (this.isStill) this.player.seek(this.player.endNs);
        else this.player.setPlaying(true);
    }

    // Everything known has been played: an agent needs a decision, or the run is over.
    reachesEnd() {
        const { player, state } = this;
        if (player === null || player.ns < player.endNs) return;
        if (state.asked.length > 0 && this.asked === null) this.showQuestion(state.asked[0]);
        if (this.finished !== null) this.showResult();
    }

    // Questions.

    showQuestion(asked) {
        this.asked = asked;
        const { run } = this.player.panes[0];
        const [x, y] = asked.place;
        const far = (cell) => Math.hypot(run.cellCentre(cell).x - x, run.cellCentre(cell).y - y);
        this.choices = asked.options.map((cell) => ({ cell, metres: far(cell) })).sort((one, other) => one.metres - other.metres);
        const others = this.state.asked.length > 1 ? ` (${this.state.asked.length} agents are waiting for an answer)` : "";
        byId("asks").textContent = `Where should ${asked.agent} go?${others} Click a ringed place, or pick one below.`;
        const option = ({ cell, metres }) => Object.assign(element("option", `${run.cellName(cell)}, ${metres.toFixed(0)} m away${this.burns(cell)}`), { value: cell });
        byId("choices").replaceChildren(...this.choices.slice(0, MAX_CHOICES).map(option));
        byId("question").hidden = false;
        byId("go").disabled = this.choices.length === 0;
        this.pointAt(this.choices[0]?.cell ?? null);
        this.leftMs = this.limitS === null ? null : 1000 * this.limitS;
        this.countDown();
    }

    burns(cell) {
        const { run } = this.player.panes[0];
        const bush = run.bushOfCell.get(cell);
        if (bush === undefined || run.kinds[bush] !== BURNING) return "";
        return `, burning for ${((this.player.endNs - run.since[bush]) / NANOS).toFixed(0)} s`;
    }

    // On a hidden page frames stop, and the countdown with them.
    countDown(before = null) {
        byId("countdown").textContent = this.leftMs === null ? "" : `${(this.leftMs / 1000).toFixed(1)} s`;
        if (this.leftMs === null || this.asked === null) return;
        const asked = this.asked;
        requestAnimationFrame((now) => {
            if (this.asked !== asked) return;
            this.leftMs = Math.max(0, this.leftMs - Math.min(now - (before ?? now), LONGEST_FRAME_MS));
            if (this.leftMs === 0) this.decide();
            else this.countDown(now);
        });
    }

    pointAt(cell) {
        this.pointedAt = cell;
        if (cell !== null) byId("choices").value = cell;
        this.player.view.marked = { cells: this.asked.options, pointedAt: cell };
        this.player.redraw();
    }

    pointNext(step) {
        const at = this.choices.findIndex(({ cell }) => cell === this.pointedAt);
        const next = this.choices[(at + step + this.choices.length) % this.choices.length];
        if (next !== undefined) this.pointAt(next.cell);
    }

    // A click on a ring answers; a click on another asked agent lets that one answer first.
    picks(pane, at) {
        if (this.asked === null) return false;
        const cell = pane.cellAt(at);
        const picked = pane.pick(at);
        const agent = picked === null || picked.agent === null ? null : pane.run.agents[picked.agent].id;
        const other = this.state.asked.find((asked) => asked.agent === agent && asked !== this.asked);
        if (other !== undefined) this.showQuestion(other);
        else if (this.asked.options.includes(cell)) this.answer(this.goTo(cell));
        else return false;
        return true;
    }

    goTo(cell) {
        const { col, row } = this.player.runs[0].cell(cell);
        return { go: [col, row] };
    }

    go() {
        if (this.pointedAt !== null) this.answer(this.goTo(this.pointedAt));
    }

    answer(choice) {
        return this.goOn({ do: "answer", choice });
    }

    decide() {
        return this.goOn({ do: "decide" });
    }

    async goOn(request) {
        const { asked, state, round } = this;
        if (asked === null) return;
        const isCurrent = () => round === this.round;
        this.asked = null;
        // No agent is asked until the module has computed the consequences.
        this.state = { ...state, asked: [] };
        byId("question").hidden = true;
        this.player.view.marked = null;
        this.player.redraw();
        const { side, number } = asked;
        try {
            const answered = await this.module.ask({ ...request, agent: { side, number } });
            const choice = request.choice ?? answered.choice;
            this.game.answers.push({ t_ns: state.now_ns, side, number, choice });
            await this.keep(this.game);
            await this.makeAhead(isCurrent);
        } catch (error) {
            if (isCurrent() && !error.isLeft) this.refuse(error);
        }
    }

    // The address of the page holds the game, so that a reload continues it.
    async keep(game) {
        const packed = await packedGame({ wildfire_game: 1, ...game });
        history.replaceState(null, "", `#${packed}`);
    }

    // The end.

    showResult() {
        const { result } = this.finished;
        const words = { wumpus: "The Wumpus wins", unimog: "The fire trucks win", tie: "A tie" };
        byId("verdict").textContent = `${words[result.winner]}: ${result.saved} of ${result.bushes} bushes saved`;
        const isOfArsonist = this.game.plays.join() === "wumpus";
        byId("bound").textContent =
            isOfArsonist || result.burned_beyond_bound === null ? "" : `Even a perfect dispatcher could have saved at most ${result.burned_beyond_bound} more.`;
        byId("link").hidden = this.game.plays.length === 0;
        byId("result").hidden = false;
        this.showRivals();
    }

    // The same run without a player, once for each policy of the side.
    async makeRivals(isCurrent) {
        this.rivals = [];
        for (const side of this.game.plays) {
            for (const { name, changes } of await this.module.ask({ do: "rivals", side })) {
                try {
                    const result = await this.module.ask({ do: "rival", changes });
                    if (!isCurrent()) return;
                    this.rivals.push({ name, side, result });
                    this.showRivals();
                } catch (error) {
                    if (error.isLeft || error.isFatal) throw error;
                    // A policy that conflicts with other rules of the scenario.
                }
            }
        }
    }

    showRivals() {
        const rows = [["you", this.finished.result], ...(this.rivals ?? []).map(({ name, result }) => [name, result])];
        if (this.game.plays.length === 0) rows[0][0] = "this run";
        const line = ([name, { saved, burned, wumpus_points, truck_points }], index) => [index === 0 ? "head" : "", name, `${saved}`, `${burned}`, formatPoints(wumpus_points), formatPoints(truck_points)];
        setRows(byId("rivals"), [["", "", "saved", "burned", "Wumpus", "trucks"], ...rows.map(line)]);
    }

    saveRecording() {
        const { name, recording } = this.finished;
        const bytes = Uint8Array.from(atob(recording), (letter) => letter.charCodeAt(0));
        save(`${name}.wildfire`, bytes, "application/octet-stream");
    }

    async copyLink() {
        await this.keep(this.finished.game);
        try {
            await navigator.clipboard.writeText(location.href);
            byId("link").textContent = "copied";
        } catch {
            byId("link").textContent = "the address of this page is the link";
        }
    }

    // Messages above the stage.

    tell(words) {
        byId("trouble").textContent = words;
        byId("trouble").hidden = words === "";
    }

    refuse({ message, advice, place }) {
        const where = place ? `Line ${place[0]}, column ${place[1]}: ` : "";
        const sentence = `${where}${message}${advice ? ` (${advice})` : ""}.`;
        this.tell(sentence[0].toUpperCase() + sentence.slice(1));
        if (!place) return;
        byId("editor").open = true;
        const text = byId("text");
        const lines = text.value.split("\n");
        const at = lines.slice(0, place[0] - 1).reduce((sum, line) => sum + line.length + 1, 0) + place[1] - 1;
        text.focus();
        text.setSelectionRange(at, at + lines[place[0] - 1].length - place[1] + 1);
    }
}

async function begin() {
    const message = byId("message");
    if (typeof WebAssembly === "undefined" || typeof DecompressionStream === "undefined" || typeof Worker === "undefined") {
        message.textContent = "This browser is too old to run the simulation: it lacks WebAssembly, DecompressionStream or Worker.";
        return;
    }
    try {
        const module = new Module(await WebAssembly.compile(await unpacked("module").arrayBuffer()));
        const desk = new Desk(module, await module.ask({ do: "catalogue" }));
        window.desk = desk;
        byId("desk").hidden = false;
        message.hidden = true;
        const setup = JSON.parse(byId("setup-data").textContent);
        let game = { ...desk.written(), ...setup };
        if (location.hash.length > 1) {
            try {
                game = await unpackedGame(location.hash.slice(1));
            } catch {
                desk.tell("The address of this page contains no valid game; a new one starts.");
            }
        }
        desk.show(game);
        const told = byId("trouble").textContent;
        const started = desk.start({ answers: [], changes: [], ...game });
        if (told !== "") desk.tell(told);
        await started;
    } catch (error) {
        message.textContent = `The simulation cannot start: ${error.message}`;
        message.hidden = false;
        throw error;
    }
}

begin();
