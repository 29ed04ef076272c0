// A page that computes its runs: it queries the module, plays the run so far, and asks the user for decisions.

// The target time of a slice of a run in milliseconds, and the longest lead of the computation in seconds of playing.
const SLICE_MS = 120;
const AHEAD_S = 30;
// The first slice, in simulated nanoseconds.
const FIRST_SLICE_NS = 600 * NANOS;
const FIRST_GAME_SPEED = 20;
// A game is shown from this long before its next question, in simulated seconds.
const LEAD_IN_S = 20;
// The policy answers for trucks unless two or more fires compete for one, and the last question was this long ago.
const ASKS_EVERY_S = 60;
// A dispatcher of a single truck has little to decide: instead of the first scenario, the second is played.
const USUAL = ["contest", "fleet"];
// An answer after which nobody was asked for this long was pointless, in seconds.
const LONG_STAND_S = 300;
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

// A game with what it leaves out, if it is one that can be played.
function checkedGame(game) {
    const refuse = (reason) => {
        throw new Error(reason);
    };
    if (game?.wildfire_game !== 1) refuse(`the game has format ${game?.wildfire_game}; expected 1`);
    const answers = game.answers ?? [];
    answers.forEach(({ side, number, choice }, index) => {
        const isKnown = Array.isArray(choice?.go) || ["wait", "stay", "go-to-nearest"].includes(choice);
        if (!isKnown) refuse(`answer ${index + 1} has no choice that exists: ${JSON.stringify(choice)}`);
        if (side === "wumpus" && choice === "go-to-nearest") refuse(`answer ${index + 1} sends wumpus/${number} to the nearest fire; only trucks can`);
    });
    return { changes: [], plays: [], ...game, answers };
}

function save(name, content, type) {
    const link = Object.assign(element("a"), { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const byId = (id) => document.getElementById(id);

class Desk {
    constructor() {
        Object.assign(this, { module: null, scenarios: [], round: 0, player: null, game: null, finished: null, asked: null, questions: 0 });
        this.emptyStage = byId("player").innerHTML;
        this.ready = new Promise((done) => (this.isReady = done));
        byId("scenario").addEventListener("change", () => this.showText());
        byId("text").addEventListener("input", () => (byId("scenario").value = ""));
        byId("setup").addEventListener("submit", (event) => {
            event.preventDefault();
            this.start();
        });
        byId("always").addEventListener("change", () => this.setAlways(byId("always").checked));
        byId("file").addEventListener("change", () => this.openFile(byId("file").files[0]));
        const fromField = (event) => event.target.matches("select, input, textarea");
        document.addEventListener("keydown", (event) => {
            if (event.key === "Escape") this.closeCards();
            if (byId("question").hidden || fromField(event) || event.ctrlKey || event.metaKey || event.altKey) return;
            const does = { "]": () => this.pointNext(1), "[": () => this.pointNext(-1), enter: () => this.go(), w: () => this.answer("wait"), p: () => this.decide() };
            const act = does[event.key.toLowerCase()];
            if (act === undefined || (event.key === "Enter" && event.target.matches("button, a, summary"))) return;
            event.preventDefault();
            act();
        });
    }

    // Plays the recorded run behind the choice of a game, again and again, while the module is made ready.
    playRecorded(data) {
        const again = () => {
            this.player.seek(data.time_ns);
            this.player.setPlaying(true);
        };
        this.recorded = data;
        this.show(data, { picks: () => false, isFinal: () => false, reachesEnd: again });
        byId("cover").hidden = false;
        this.player.setSpeed(FIRST_GAME_SPEED);
        this.isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
        if (this.isStill) this.player.seek(0.6 * this.player.endNs);
        else this.player.setPlaying(true);
    }

    takeModule(module, catalogue) {
        Object.assign(this, { module, scenarios: catalogue.scenarios });
        const option = (text, value = text) => Object.assign(element("option", text), { value });
        byId("scenario").append(...catalogue.scenarios.map(({ name }) => option(name)), option("your own text", ""));
        byId("planner").append(option("default", ""), ...catalogue.planners.map((name) => option(name)));
        this.isReady();
    }

    // A side's game as the form says otherwise.
    play(...plays) {
        const game = { ...this.written(), plays };
        if (plays[0] === "unimog" && game.scenario.name === USUAL[0]) game.scenario = { name: USUAL[1] };
        return this.start(game);
    }

    // What a button of the choice does, as soon as the module is ready.
    async choose(...plays) {
        if (this.module === null) this.say("The simulation starts …");
        if (plays.length === 0) byId("cover").hidden = true;
        await this.ready;
        return this.play(...plays);
    }

    async openFile(file) {
        if (file === undefined) return;
        byId("file").value = "";
        await this.startFrom(file.name, async () => JSON.parse(await file.text()));
    }

    // Starts a game that comes from somewhere, or says why that is none.
    async startFrom(where, read) {
        let game = null;
        try {
            game = checkedGame(await read());
        } catch (error) {
            const reason = error.constructor === Error ? `: ${error.message}` : "";
            this.tell(`${where} contains no valid game${reason}.`);
            byId("cover").hidden = false;
            return;
        }
        await this.start(game);
    }

    setAlways(isOn) {
        this.asksAlways = isOn;
        byId("always").checked = isOn;
        byId("ask-always").setAttribute("aria-pressed", `${isOn}`);
    }

    closeCards() {
        byId("result").hidden = true;
        byId("desk").open = false;
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
    fillIn({ scenario, changes = [], seed, plays }) {
        byId("scenario").value = scenario.name ?? "";
        if (scenario.text !== undefined) byId("text").value = scenario.text;
        this.showText();
        byId("seed").value = seed;
        byId("side").value = plays.join(" ");
        byId("planner").value = changes.find((change) => change.startsWith("unimog.planner="))?.slice("unimog.planner=".length) ?? "";
    }

    async start(game = this.written()) {
        await this.ready;
        const round = ++this.round;
        const isCurrent = () => round === this.round;
        if (this.isBusy) this.module.restart();
        this.isBusy = true;
        this.player?.close();
        Object.assign(this, { player: null, game, state: null, finished: null, asked: null, rivals: [], limitS: Number(byId("limit").value) || null });
        Object.assign(this, { questions: 0, lastAskedNs: -Infinity });
        this.fillIn(game);
        this.closeCards();
        this.tell("");
        this.say("");
        try {
            const { wildfire_game, ...given } = game;
            this.opened = await this.module.ask({ do: "open", ...given, searches: byId("searches").checked });
            await this.makeAhead(isCurrent);
        } catch (error) {
            if (isCurrent() && !error.isLeft) {
                if (this.player === null) this.playRecorded(this.recorded);
                this.refuse(error);
            }
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
            if (state.asked.length > 0 && this.questionOf(state) === undefined) {
                // Nobody else is asked meanwhile.
                this.state = { ...state, asked: [] };
                await this.letPolicyAnswer(state.asked[0]);
                if (!isCurrent()) return;
                continue;
            }
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
            if (!isCurrent()) return;
            // The panel says who won instead of who leads.
            this.player.isStale = true;
            this.reachesEnd();
            await this.makeRivals(isCurrent);
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
        const host = {
            picks: (pane, at) => this.picks(pane, at),
            isFinal: () => this.finished !== null,
            reachesEnd: () => this.reachesEnd(),
            hasCard: true,
        };
        this.show(page, host);
        const title = `${this.opened.scenario}, seed ${this.game.seed}`;
        document.querySelector("h1").textContent = title;
        document.title = `${title} – wildfire`;
        document.body.classList.toggle("is-game", this.game.plays.length > 0);
        this.setAlways(this.asksAlways ?? false);
        // A player sees what leads to the question; with reduced motion, only the result.
        if (this.game.plays.length > 0) {
            this.player.setSpeed(FIRST_GAME_SPEED);
            this.player.seek(this.player.endNs - LEAD_IN_S * NANOS);
        }
        if (this.isStill) this.player.seek(this.player.endNs);
        else this.player.setPlaying(true);
    }

    // A new player on a clean stage, without a cover.
    show(data, host) {
        byId("player").innerHTML = this.emptyStage;
        byId("player").hidden = false;
        byId("cover").hidden = true;
        byId("light").addEventListener("click", () => this.choose("wumpus"));
        byId("fight").addEventListener("click", () => this.choose("unimog"));
        byId("watch").addEventListener("click", () => this.choose());
        byId("another").addEventListener("click", () => this.start({ ...this.game, seed: this.game.seed + 1, answers: [] }));
        byId("other").addEventListener("click", () => this.start({ ...this.game, plays: [this.otherSide], answers: [] }));
        byId("close-result").addEventListener("click", () => this.closeCards());
        byId("ask-always").addEventListener("click", () => this.setAlways(!this.asksAlways));
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
        this.player = new Player(data, host);
        window.wildfire = this.player;
    }

    // Everything known has been played: an agent needs a decision, or the run is over.
    reachesEnd() {
        const { player, state } = this;
        if (player === null || player.ns < player.endNs) return;
        if (state.asked.length > 0 && this.asked === null) {
            this.questions += 1;
            this.showQuestion(this.questionOf(state));
        }
        if (this.finished !== null) this.showResult();
    }

    // Questions.

    // The question that the player is asked; undefined if the policy answers all of a moment.
    questionOf({ asked, now_ns }) {
        if (this.asksAlways) return asked[0];
        const isDue = now_ns - this.lastAskedNs >= ASKS_EVERY_S * NANOS;
        return asked.find(({ side, options }) => options.length > 1 && (side === "wumpus" || isDue));
    }

    async letPolicyAnswer({ side, number }) {
        const { choice } = await this.module.ask({ do: "decide", agent: { side, number } });
        this.game.answers.push({ t_ns: this.state.now_ns, side, number, choice });
    }

    showQuestion(asked) {
        this.asked = asked;
        const { run } = this.player.panes[0];
        const place = { x: asked.place[0], y: asked.place[1] };
        const far = (cell) => Math.hypot(run.cellCentre(cell).x - place.x, run.cellCentre(cell).y - place.y);
        const isTruck = asked.side === "unimog";
        this.choices = asked.options.map((cell) => ({ cell, metres: far(cell) })).sort((one, other) => one.metres - other.metres);
        const isAlone = run.agents.filter(({ is_truck }) => is_truck === isTruck).length === 1;
        const who = `the ${isTruck ? "truck" : "Wumpus"}`;
        byId("asks").textContent = `Where should ${isAlone ? who : asked.agent} go? Click a ringed ${isTruck ? "fire" : "bush"}, or pick one below.`;
        byId("ask-always").hidden = !isTruck;
        byId("ask-always").title = "otherwise at most once a minute, when two or more fires compete for a truck";
        const option = ({ cell }) => Object.assign(element("option", `${run.wayTo(cell, place)}${this.burns(cell)}`), { value: cell });
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
        // Who waits is asked again soon.
        this.lastAskedNs = request.choice === "wait" ? -Infinity : state.now_ns;
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
        const { plays } = this.game;
        const [run] = this.player.runs;
        const isOwn = plays.length === 1 && run.isContest && result.winner !== "tie";
        byId("verdict").textContent = `${isOwn ? (plays[0] === result.winner ? "You won. " : "You lost. ") : ""}${run.verdict}.`;
        const bound = result.burned_beyond_bound;
        byId("bound").textContent = bound === null || run.isOfGround ? "" : `Even a perfect dispatcher, who knows the future, could have saved at most ${bound} more.`;
        byId("stood").textContent = this.pointless;
        byId("link").hidden = plays.length === 0;
        byId("other").hidden = plays.length !== 1 || !run.isContest;
        byId("result").hidden = false;
        byId("verdict").focus({ preventScroll: true });
        document.body.classList.remove("is-game");
        this.showRivals();
    }

    get otherSide() {
        return this.game.plays[0] === "wumpus" ? "unimog" : "wumpus";
    }

    // A sentence on a last answer that made an agent stand until the end.
    get pointless() {
        const last = this.finished.game.answers.at(-1);
        if (last === undefined || last.choice !== "stay") return "";
        const stoodS = this.finished.result.ended_s - last.t_ns / NANOS;
        return stoodS < LONG_STAND_S ? "" : `${last.side}/${last.number} stood still for the last ${(stoodS / 60).toFixed(0)} min: “stay” lasts until something happens, and nothing did.`;
    }

    // The same run without a player, once for each policy of the side.
    async makeRivals(isCurrent) {
        // Whoever comes to the end again begins again.
        const rivals = [];
        this.rivals = rivals;
        for (const side of this.game.plays) {
            for (const { name, changes } of await this.module.ask({ do: "rivals", side })) {
                try {
                    const result = await this.module.ask({ do: "rival", changes });
                    if (!isCurrent() || this.rivals !== rivals) return;
                    rivals.push({ name, side, result });
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
            byId("link").textContent = "link copied";
        } catch {
            byId("link").textContent = "the address of this page is the link";
        }
    }

    // Messages above the stage.

    say(words) {
        byId("message").textContent = words;
        byId("message").hidden = words === "";
    }

    tell(words) {
        byId("trouble").textContent = words;
        byId("trouble").hidden = words === "";
    }

    refuse({ message, advice, place }) {
        const where = place ? `Line ${place[0]}, column ${place[1]}: ` : "";
        const sentence = `${where}${message}${advice ? ` (${advice})` : ""}.`;
        this.tell(sentence[0].toUpperCase() + sentence.slice(1));
        if (!place) return;
        byId("desk").open = true;
        byId("editor").open = true;
        const text = byId("text");
        const lines = text.value.split("\n");
        const at = lines.slice(0, place[0] - 1).reduce((sum, line) => sum + line.length + 1, 0) + place[1] - 1;
        text.focus();
        text.setSelectionRange(at, at + lines[place[0] - 1].length - place[1] + 1);
    }
}

async function begin() {
    const desk = new Desk();
    if (typeof DecompressionStream === "undefined") {
        desk.say("This browser is too old to play runs: it lacks DecompressionStream.");
        return;
    }
    desk.playRecorded(await unpacked("run-data").json());
    window.desk = desk;
    desk.say("");
    const setup = JSON.parse(byId("setup-data").textContent);
    // A game that is there already needs no choice.
    byId("cover").hidden = location.hash.length > 1 || setup.plays.length > 0;
    // The module, which stands at the end of the page, is decoded after the first pictures.
    for (let frame = 0; frame < 3 || document.readyState === "loading"; frame++) await new Promise(requestAnimationFrame);
    if (typeof WebAssembly === "undefined" || typeof Worker === "undefined") {
        byId("cover").hidden = byId("desk").hidden = true;
        desk.tell("This browser is too old to run the simulation: it lacks WebAssembly or Worker. You see a recorded run.");
        return;
    }
    try {
        const module = new Module(await WebAssembly.compile(await unpacked("module").arrayBuffer()));
        desk.takeModule(module, await module.ask({ do: "catalogue" }));
        desk.fillIn(setup);
        if (location.hash.length > 1) await desk.startFrom("The address of this page", () => unpackedGame(location.hash.slice(1)));
        else if (setup.plays.length > 0) await desk.startFrom("This page", () => setup);
    } catch (error) {
        desk.say(`The simulation cannot start: ${error.message}`);
        throw error;
    }
}

begin();
