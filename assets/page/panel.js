// Text and numbers beside the fields: clock, counts, scores, agents, and the story of the selected agent or bush, as in the
// program's pictures.

// Elapsed hours, minutes, seconds and tenths.
function formatClock(ns) {
    const tenths = Math.floor(ns / 1e8);
    const seconds = Math.floor(tenths / 10);
    const two = (number) => `${number}`.padStart(2, "0");
    return `${Math.floor(seconds / 3600)}:${two(Math.floor(seconds / 60) % 60)}:${two(seconds % 60)}.${tenths % 10}`;
}

function formatPercent(part, whole) {
    return `${((100 * part) / Math.max(1, whole)).toFixed(1)} %`;
}

// With ordinary rules, points are integers.
function formatPoints(score) {
    return Number.isInteger(score) ? `${score}` : score.toFixed(1);
}

function formatHectares(hectares) {
    return `${hectares < 100 ? hectares.toFixed(2) : hectares.toFixed(0)} ha`;
}

function formatMetres(metres) {
    return metres < 1000 ? `${metres.toFixed(0)} m` : `${(metres / 1000).toFixed(2)} km`;
}

function element(name, text = "", className = "") {
    const made = document.createElement(name);
    made.textContent = text;
    if (className !== "") made.className = className;
    return made;
}

// Replaces the rows of a table that have changed; a row is a class followed by the texts of its cells.
function setRows(table, rows) {
    const key = JSON.stringify(rows);
    if (table.dataset.rows === key) return;
    table.dataset.rows = key;
    table.replaceChildren(
        ...rows.map(([className, ...texts]) => {
            const row = element("tr", "", className);
            row.append(...texts.map((text, index) => element(index === 0 ? "th" : "td", text)));
            return row;
        }),
    );
}

class Panel {
    constructor(data, runs) {
        Object.assign(this, { runs, stateNames: data.state_names });
        this.parts = Object.fromEntries(["counts", "scores", "story", "agents"].map((id) => [id, document.getElementById(id)]));
        this.isComparison = runs.length > 1;
        document.getElementById("panel").classList.toggle("two", this.isComparison);
        this.isFinal = true;
        this.drawSigns(data);
        const entries = data.legend.filter(([kind, , text]) => this.isThere(kind, text)).map(([kind, colour, text]) => {
            const [entry, sign] = [element("li"), element("i", "", kind)];
            sign.style.background = colour;
            entry.append(sign, text);
            return entry;
        });
        document.getElementById("legend").replaceChildren(...entries);
        document.getElementById("points").textContent = runs[0].isOfGround ? "" : runs[0].points;
    }

    // Whether a run has anything that an entry of the legend explains.
    isThere(kind, text) {
        const agents = this.runs.flatMap((run) => run.agents);
        const hasTrucks = agents.some(({ is_truck }) => is_truck);
        if (kind === "driven" || kind === "planned") return agents.length > 0;
        if (kind === "reverse" || kind === "unimog") return hasTrucks;
        if (kind === "wumpus") return agents.some(({ is_truck }) => !is_truck);
        if (text === "lost line") return this.runs.some(({ ground }) => ground?.line.holds.includes(0));
        return text !== "wet" || hasTrucks;
    }

    // A bush in each state, before its name.
    drawSigns(data) {
        this.signs = data.state_names.map((_, kind) => {
            const [canvas, sheet] = [document.createElement("canvas"), document.createElement("canvas")];
            const side = 18 * Math.max(1, devicePixelRatio);
            Object.assign(canvas, { width: 1.4 * side, height: 1.4 * side, className: "sign" });
            const pane = new FieldPane(sheet, data, this.runs[0], 0);
            const context = canvas.getContext("2d");
            const middle = [0.5 * canvas.width, 0.5 * canvas.height];
            pane.drawLeaning(context, pane.sprites[["bush", "embers", "burned", "wet"][kind]], middle, [side, side], -0.12);
            if (kind === BURNING) pane.drawTongues(context, middle, [side, side], 0);
            return canvas.toDataURL();
        });
    }

    show(ns, view) {
        const times = this.runs.map((run) => Math.min(ns, run.end_ns));
        const counts = this.runs.map((run, index) => run.countsAt(times[index]));
        this.showCounts(counts, times);
        this.showScores(counts, times);
        this.showAgents(times);
        this.showStory(times, view);
    }

    get heads() {
        return this.isComparison ? ["A", "B"] : [];
    }

    showCounts(counts, times) {
        const table = this.parts.counts;
        if (this.runs.every((run) => run.isOfGround)) {
            setRows(table, this.groundRows(counts, times));
            return;
        }
        const rows = this.stateNames.map((name, kind) => {
            const numbers = counts.map(({ bushes }) => `${bushes[kind]}`);
            const all = this.runs[0].bushCells.length;
            const share = this.isComparison ? [] : [formatPercent(counts[0].bushes[kind], all)];
            return [`state-${kind}`, name, ...numbers, ...share];
        });
        if (this.runs.some(({ ground }) => ground !== null)) {
            const hectares = this.runs.map(({ ground }, index) => ground?.hectaresAt(times[index]));
            const row = (name, which) => ["ground", name, ...hectares.map((known) => known?.[which].toFixed(2) ?? "-")];
            rows.push(row("ground on fire, ha", "burning"), row("ground burned, ha", "burned"));
        }
        setRows(table, this.isComparison ? [["head", "bushes", "A", "B"], ...rows] : rows);
        this.stateNames.forEach((_, kind) => {
            const head = table.querySelector(`.state-${kind} th`);
            if (head.querySelector("img") === null) {
                const sign = element("img");
                Object.assign(sign, { src: this.signs[kind], alt: "" });
                head.prepend(sign);
            }
        });
    }

    // A fire on the ground: what burns, and who works against it.
    groundRows(counts, times) {
        const row = (name, text) => ["fire", name, ...this.runs.map((run, index) => text(run, times[index], index))];
        const atWork = (run, ns) => run.agents.filter((agent) => ![STANDING, WAITING].includes(agent.at(ns).activity)).length;
        const rows = [
            row("on fire", ({ ground }, ns) => formatHectares(ground.hectaresAt(ns).burning)),
            row("burned", ({ ground }, ns) => formatHectares(ground.hectaresAt(ns).burned)),
            row("perimeter", ({ ground }, ns) => formatMetres(ground.perimeterAt(ns))),
        ];
        const has = (what) => this.runs.some(what);
        if (has(({ agents }) => agents.length > 0)) rows.push(row("trucks at work", (run, ns) => `${atWork(run, ns)} of ${run.agents.length}`));
        if (has(({ ground }) => ground.crews.length > 0)) {
            rows.push(row("crews at work", ({ ground }, ns) => `${lastAt(ground.crews, ns) + 1} of ${ground.crews.length}`));
        }
        if (has(({ bushCells }) => bushCells.length > 0)) {
            rows.push(row("bushes burned", ({ bushCells }, _, index) => {
                const { bushes } = counts[index];
                return `${bushes[BURNING] + bushes[BURNED_OUT]} of ${bushCells.length}`;
            }));
        }
        return this.isComparison ? [["head", "", "A", "B"], ...rows] : rows;
    }

    showScores(counts, times) {
        const points = (side) => counts.map((count) => formatPoints(count[side]));
        const leader = ({ wumpus, truck }) => (wumpus > truck ? "Wumpus" : truck > wumpus ? "Unimog" : null);
        // Only sides with agents have points, and one can lead only if both have agents.
        const has = (isTruck) => this.runs.some(({ agents }) => agents.some(({ is_truck }) => is_truck === isTruck));
        const [hasWumpus, hasTruck] = [has(false), has(true)];
        const rows = [];
        if (hasWumpus) rows.push(["wumpus", "Wumpus", ...points("wumpus")]);
        if (hasTruck) rows.push(["unimog", "Unimog", ...points("truck")]);
        const isContest = rows.length === 2;
        const isOver = this.runs.map((run, index) => this.isFinal && times[index] >= run.end_ns);
        if (this.isComparison) rows.unshift(["head", "points", ...this.heads]);
        if (this.isComparison && isContest) rows.push(["faint", isOver.every((over) => over) ? "won" : "leads", ...counts.map((count) => leader(count) ?? "-")]);
        setRows(this.parts.scores, rows);
        this.parts.scores.parentElement.hidden = (!hasWumpus && !hasTruck) || this.runs.every((run) => run.isOfGround);
        const [bar, lead] = [document.getElementById("score-bar"), document.getElementById("lead")];
        bar.hidden = lead.hidden = this.isComparison || !isContest;
        const { wumpus, truck } = counts[0];
        const all = Math.max(0, wumpus) + Math.max(0, truck);
        bar.style.setProperty("--share", all > 0 ? `${(100 * Math.max(0, wumpus)) / all}%` : "0%");
        bar.classList.toggle("empty", all === 0);
        const name = leader(counts[0]);
        const by = formatPoints(Math.abs(wumpus - truck));
        lead.textContent = name === null ? "tied" : `${name} ${isOver[0] ? "won" : "leads"} by ${by}`;
        lead.classList.toggle("won", isOver[0]);
    }

    showAgents(times) {
        const isCrowded = this.runs.some((run) => run.agents.length > MAX_ONE_BY_ONE);
        const rows = isCrowded ? this.fleetRows(times) : this.agentRows(times);
        setRows(this.parts.agents, rows);
        this.parts.agents.parentElement.hidden = rows.length === 0;
    }

    agentRows(times) {
        if (!this.isComparison) {
            return this.runs[0].agents.flatMap((agent) => {
                const [state, stats] = [agent.at(times[0]), agent.statsAt(times[0])];
                const goal = state.goal < 0 ? "no goal" : `goal ${this.runs[0].wayTo(state.goal, agent.centre(state))}`;
                return [
                    [agent.is_truck ? "unimog name" : "wumpus name", agent.id, agent.activities[state.activity]],
                    ["faint", goal, `${stats.cells} ${agent.cells_word}`],
                    ["faint", `${stats.plans} routes planned, ${stats.failures} failed`, `${stats.expansions} search steps`],
                ];
            });
        }
        const ids = [...new Set(this.runs.flatMap((run) => run.agents.map(({ id }) => id)))];
        return ids.flatMap((id) => {
            const known = this.runs.map((run, index) => {
                const agent = run.agents.find((other) => other.id === id);
                return agent && { agent, state: agent.at(times[index]), stats: agent.statsAt(times[index]) };
            });
            const one = known.find((run) => run !== undefined);
            const tell = (name, text) => ["faint", name, ...known.map((run) => (run === undefined ? "-" : text(run)))];
            return [
                [one.agent.is_truck ? "unimog name" : "wumpus name", id, ...this.heads],
                tell("does", ({ agent, state }) => agent.activities[state.activity]),
                tell(one.agent.cells_word, ({ stats }) => `${stats.cells}`),
                tell("routes planned, failed", ({ stats }) => `${stats.plans}, ${stats.failures}`),
            ];
        });
    }

    // With too many agents to list one by one, counts by role and activity.
    fleetRows(times) {
        return [false, true].flatMap((isTruck) => {
            const sums = this.runs.map((run, index) => this.sumsOf(run, times[index], isTruck));
            if (sums.every(({ agents }) => agents === 0)) return [];
            const line = (name, count, className = "") => [className, name, ...sums.map((sum) => `${count(sum)}`)];
            const word = isTruck ? "trucks" : "Wumpuses";
            const rows = [line(word, ({ agents }) => agents, isTruck ? "unimog name" : "wumpus name")];
            rows.push(line(isTruck ? "put out" : "lit", ({ cells }) => cells));
            if (isTruck) {
                rows.push(line("driving to a fire", ({ toward }) => toward));
                rows.push(line("suppressing", ({ does }) => does[SUPPRESSING]));
                rows.push(line("standing", ({ does }) => does[STANDING]));
                rows.push(line("waiting for others", ({ does }) => does[WAITING]));
                rows.push(line("planning", ({ does }) => does[PLANNING]));
                rows.push(line("driving elsewhere", ({ does, toward }) => does[DRIVING] - toward));
                if (this.runs.some((run) => run.water !== null)) rows.push(line("refilling", ({ does }) => does[REFILLING]));
                rows.push(line("too late for their fire", ({ late }) => late, "faint"));
            } else {
                rows.push(line("walking", ({ does }) => does[DRIVING]));
                rows.push(line("standing or planning", ({ does }) => does[STANDING] + does[WAITING] + does[PLANNING]));
            }
            rows.push(line("routes planned, failed", ({ plans, failures }) => `${plans}, ${failures}`, "faint"));
            return rows;
        });
    }

    sumsOf(run, ns, isTruck) {
        const sums = { agents: 0, does: [0, 0, 0, 0, 0, 0], toward: 0, late: 0, cells: 0, plans: 0, failures: 0 };
        for (const agent of run.agents.filter(({ is_truck }) => is_truck === isTruck)) {
            const [state, stats] = [agent.at(ns), agent.statsAt(ns)];
            sums.agents += 1;
            sums.does[state.activity] += 1;
            if (state.activity === DRIVING && state.goal >= 0) sums.toward += 1;
            sums.late += this.isTooLate(run, agent, state, ns) ? 1 : 0;
            for (const name of ["cells", "plans", "failures"]) sums[name] += stats[name];
        }
        return sums;
    }

    // Whether the fire that a truck drives to or suppresses burns out first.
    isTooLate(run, agent, state, ns) {
        if (!agent.is_truck) return false;
        const bush = run.bushOfCell.get(state.goal);
        if (bush === undefined) return false;
        const arrives = state.activity === SUPPRESSING ? agent.stopAt(ns).sinceNs : state.leg?.endNs;
        return arrives !== undefined && run.isHopeless(bush, arrives);
    }

    showStory(times, view) {
        const { selected } = view;
        const { story } = this.parts;
        story.parentElement.hidden = selected === null;
        if (selected === null) return;
        const [run, ns] = [this.runs[selected.run], times[selected.run]];
        const suffix = this.isComparison ? ` in ${"AB"[selected.run]}` : "";
        const heading = document.getElementById("story-heading");
        if (selected.bush !== null) {
            const { col, row } = run.cell(run.bushCells[selected.bush]);
            heading.textContent = `bush in column ${col}, row ${row}${suffix}`;
            setRows(story, this.bushStory(run, selected.bush, ns, view.showsAhead ? run.end_ns : view.seenNs));
        } else {
            heading.textContent = `${run.agents[selected.agent].id}${suffix}`;
            setRows(story, this.agentStory(run, run.agents[selected.agent], ns));
        }
    }

    // The events of a bush with their times, as far as the viewer has seen the run; future ones are faint.
    bushStory(run, bush, ns, untilNs) {
        const rows = [["", "intact", formatClock(0)]];
        run.changes.times.forEach((time, index) => {
            if (run.changes.bushes[index] !== bush || time > untilNs) return;
            const className = time <= ns ? "" : "ahead";
            rows.push([className, run.texts[run.changes.words[index]], formatClock(time)]);
            const burned = run.changes.burned[index];
            if (burned >= 0) rows.push([`${className} inner`, run.texts[burned], ""]);
        });
        return rows.slice(-12);
    }

    agentStory(run, agent, ns) {
        const [state, stats] = [agent.at(ns), agent.statsAt(ns)];
        const rows = [
            ["", agent.activities[state.activity], `${state.speed.toFixed(1)} m/s`],
            ["", "goal", state.goal < 0 ? "none" : run.wayTo(state.goal, agent.centre(state))],
            ["", "distance", `${stats.distanceM.toFixed(0)} m`],
            ["", "bushes", `${stats.cells} ${agent.cells_word}`],
            ["", "routes planned", `${stats.plans} (${stats.failures} failed)`],
        ];
        if (stats.failure >= 0) rows.push(["faint", "last failure", run.texts[stats.failure]]);
        for (const activity of [DRIVING, PLANNING, SUPPRESSING, REFILLING, WAITING, STANDING]) {
            if (stats.spent[activity] > 0) rows.push(["faint", agent.activities[activity], formatClock(stats.spent[activity])]);
        }
        return rows;
    }
}
