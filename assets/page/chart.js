// The curves over time, which form the timeline: stacked counts of bushes by state, with marks of events above; for two runs
// also their difference. Ground that burns is shown in hectares. What was seen before is paler, and what is still to come is not
// shown, unless the viewer wants it.

// All in pixels of the page.
const CHART_LEFT = 64;
const CHART_RIGHT = 14;
const LANE = 11;
const STRIP = 96;
const DIFFERENCE = 64;
const AXIS = 24;
const GAP = 12;
// Between the marks of events and the curves.
const BELOW_LANES = 5;
// The share of colour that what comes later keeps.
const AHEAD = 0.35;
// Lost, burning, saved and intact, from the bottom up.
const STACKED = [BURNED_OUT, BURNING, EXTINGUISHED, INTACT];

// The least of 1, 2, 2.5 or 5 times a power of ten that is not less.
function roundStep(least) {
    const power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((step) => step >= least * (1 - 1e-9));
}

class Chart {
    constructor(canvas, data, runs) {
        Object.assign(this, { canvas, runs, colours: data.colours, stateColours: data.state_colours });
        this.context = canvas.getContext("2d");
        this.kept = ["past", "ahead", "unseen"].map(() => document.createElement("canvas"));
        this.seenNs = 0;
        this.takeRuns();
    }

    // Draws the current state of the runs.
    takeRuns() {
        // A run without fire ends immediately, and a game may ask at its start.
        this.endNs = Math.max(NANOS, ...this.runs.map((run) => run.end_ns));
        this.keptKey = "";
        this.lanes = Math.max(...this.runs.map((run) => this.lanesOf(run).length));
    }

    // Lanes of marks above the curves of a run: verdicts on decisions have one if there are any.
    lanesOf(run) {
        const changes = (kind) => run.changes.times.filter((_, index) => run.changes.to[index] === kind);
        const lanes = run.isOfGround
            ? [["embers", [[this.colours.burning, run.ground.spotTimes]]]]
            : [
                  ["ignitions", [[this.colours.burning, changes(BURNING)]]],
                  ["put out", [[this.colours.extinguished, changes(EXTINGUISHED)]]],
              ];
        if (run.agents.length > 0) lanes.push(["failed", [[this.ink, run.failedPlans]]]);
        if (this.runs.some(({ verdicts }) => verdicts.length > 0)) lanes.push(["decisions", run.verdicts]);
        return lanes;
    }

    // The height of the curves: all bushes, or a round number of hectares above those seen to burn.
    mostOf(run) {
        if (!run.isOfGround) return run.without_intact ?? Math.max(1, run.bushCells.length);
        return roundStep(Math.max(1e-3, run.ground.hectaresAt(this.seenNs).burned));
    }

    // Its height in pixels of the page.
    get height() {
        const each = this.lanes * LANE + BELOW_LANES + STRIP + GAP;
        return this.runs.length * each + (this.runs.length > 1 ? DIFFERENCE + 2 * GAP : 0) + AXIS;
    }

    // The time at a horizontal position in pixels of the page.
    timeAt(x) {
        const width = this.canvas.clientWidth - CHART_LEFT - CHART_RIGHT;
        return clamp((x - CHART_LEFT) / width, 0, 1) * this.endNs;
    }

    draw(ns, pixelRatio, seenNs) {
        const { canvas, context } = this;
        const size = [canvas.clientWidth, this.height];
        const theme = getComputedStyle(document.documentElement);
        this.ink = theme.getPropertyValue("--ink").trim();
        this.faint = theme.getPropertyValue("--faint").trim();
        this.paper = theme.getPropertyValue("--paper").trim();
        this.seenNs = seenNs;
        const key = [size, pixelRatio, this.ink, ...this.runs.map((run) => this.mostOf(run))].join("|");
        if (key !== this.keptKey) {
            this.keptKey = key;
            Object.assign(canvas, { width: Math.round(size[0] * pixelRatio), height: Math.round(size[1] * pixelRatio) });
            this.kept.forEach((kept, index) => this.drawKept(kept, size, pixelRatio, [1, AHEAD, 0][index]));
        }
        const placeOf = (time) => CHART_LEFT + (Math.min(time, this.endNs) / this.endNs) * (size[0] - CHART_LEFT - CHART_RIGHT);
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.clearRect(0, 0, canvas.width, canvas.height);
        context.drawImage(this.kept[2], 0, 0);
        [[1, seenNs], [0, ns]].forEach(([index, time]) => {
            const column = time >= this.endNs ? canvas.width : Math.round(placeOf(time) * pixelRatio);
            if (column <= 0) return;
            context.clearRect(0, 0, column, canvas.height);
            context.drawImage(this.kept[index], 0, 0, column, canvas.height, 0, 0, column, canvas.height);
        });
        this.drawCursor(placeOf(ns), size, pixelRatio);
    }

    drawCursor(x, [, height], pixelRatio) {
        const { context } = this;
        context.setTransform(pixelRatio, 0, 0, pixelRatio, 0, 0);
        const bottom = height - AXIS + 4;
        for (const [wider, colour] of [[1, this.paper], [0, this.ink]]) {
            context.fillStyle = colour;
            context.fillRect(x - 0.75 - wider, 0, 1.5 + 2 * wider, bottom);
            context.beginPath();
            const half = 6 + wider;
            context.moveTo(x - half, 0);
            context.lineTo(x + half, 0);
            context.lineTo(x + half, 5);
            context.lineTo(x, 12 + wider);
            context.lineTo(x - half, 5);
            context.fill();
        }
    }

    // Everything except the cursor, with counts and events in a share of their colour.
    drawKept(kept, [width, height], pixelRatio, share) {
        Object.assign(kept, { width: this.canvas.width, height: this.canvas.height });
        const context = kept.getContext("2d");
        context.setTransform(pixelRatio, 0, 0, pixelRatio, 0, 0);
        context.font = `12px ${FONT}`;
        const area = { left: CHART_LEFT, width: width - CHART_LEFT - CHART_RIGHT };
        let top = GAP;
        this.runs.forEach((run, runIndex) => {
            this.drawLanes(context, run, { ...area, top }, share);
            const strip = { ...area, top: top + this.lanes * LANE + BELOW_LANES, height: STRIP };
            const most = this.mostOf(run);
            this.drawStacked(context, run, strip, most, share, pixelRatio);
            this.drawValues(context, strip, [0, most], !run.isOfGround);
            if (run.isOfGround) this.note(context, "hectares burned, and on fire", strip);
            else if (run.without_intact !== null) this.note(context, "without intact bushes", strip);
            if (this.runs.length > 1) {
                context.textAlign = "left";
                context.font = `bold 18px ${FONT}`;
                context.fillStyle = this.ink;
                context.fillText("AB"[runIndex], 4, strip.top + 0.5 * STRIP + 6);
                context.font = `12px ${FONT}`;
            }
            top += this.lanes * LANE + BELOW_LANES + STRIP + GAP;
        });
        if (this.runs.length > 1) this.drawDifference(context, { ...area, top: top + GAP, height: DIFFERENCE }, share);
        this.drawTimes(context, area, height - AXIS);
    }

    note(context, text, { left, top }) {
        context.textAlign = "left";
        context.fillStyle = this.ink;
        context.fillText(text, left + 6, top + 14);
    }

    drawLanes(context, run, { left, top, width }, share) {
        this.lanesOf(run).forEach(([name, marks], index) => {
            const laneTop = top + index * LANE;
            context.globalAlpha = share;
            for (const [colour, times] of marks) {
                context.fillStyle = colour;
                for (const time of times) context.fillRect(left + (time / this.endNs) * width, laneTop + 1, 1, LANE - 3);
            }
            context.globalAlpha = 0.75;
            context.textAlign = "right";
            context.font = `10px ${FONT}`;
            context.fillStyle = this.ink;
            context.fillText(name, left - 6, laneTop + LANE - 2);
            context.font = `12px ${FONT}`;
            context.globalAlpha = 1;
        });
    }

    // A column of pixels shows the counts at its centre.
    drawStacked(context, run, { left, top, width, height }, most, share, pixelRatio) {
        const columns = Math.round(width * pixelRatio);
        context.globalAlpha = share;
        for (let column = 0; column < columns; column++) {
            const amounts = this.amountsAt(run, ((column + 0.5) / columns) * this.endNs);
            let below = 0;
            for (const kind of STACKED) {
                if (kind === INTACT && run.without_intact !== null) continue;
                const [from, to] = [below, Math.min(most, below + amounts[kind])];
                below = to;
                if (from === to) continue;
                context.fillStyle = this.stateColours[kind];
                const y = top + height * (1 - to / most);
                context.fillRect(left + column / pixelRatio, y, 1 / pixelRatio, (height * (to - from)) / most);
                // On dark paper, burned-out bushes need an outline.
                if (kind !== BURNED_OUT) continue;
                context.fillStyle = this.faint;
                context.fillRect(left + column / pixelRatio, y - 0.5, 1 / pixelRatio, 1);
            }
        }
        context.globalAlpha = 1;
    }

    // Bushes by state, or hectares that are burning or burned out.
    amountsAt(run, ns) {
        if (!run.isOfGround) return run.countsAt(ns).bushes;
        const { burning, burned } = run.ground.hectaresAt(Math.min(ns, run.end_ns));
        return { [BURNING]: burning, [BURNED_OUT]: Math.max(0, burned - burning), [EXTINGUISHED]: 0, [INTACT]: 0 };
    }

    drawValues(context, { left, top, height }, [low, high], isWhole = true) {
        const step = Math.max(isWhole ? 1 : 0, roundStep((high - low) / (height / 28)));
        context.fillStyle = this.faint;
        context.fillRect(left - 1, top, 1, height);
        context.textAlign = "right";
        for (let value = Math.ceil(low / step) * step; value <= high * (1 + 1e-9); value += step) {
            const y = top + height * (1 - (value - low) / (high - low));
            context.fillStyle = this.ink;
            context.fillRect(left - 4, Math.min(y, top + height - 1), 3, 1);
            context.fillText(`${Number(value.toPrecision(6))}`.replace("-", "\u2212"), left - 7, y + 4);
        }
    }

    // The counts of the first run minus those of the second.
    drawDifference(context, area, share) {
        const { left, top, width, height } = area;
        const isOfGround = this.runs.every((run) => run.isOfGround);
        const burned = (amounts) => amounts[BURNING] + amounts[BURNED_OUT];
        const curves = [[isOfGround ? "burned, ha" : "burned", this.colours.burning, burned]];
        if (!isOfGround) curves.push(["extinguished", this.colours.extinguished, (amounts) => amounts[EXTINGUISHED]]);
        const columns = Math.round(width);
        const differences = curves.map(([, , count]) =>
            Array.from({ length: columns }, (_, column) => {
                const [one, other] = this.runs.map((run) => count(this.amountsAt(run, ((column + 0.5) / columns) * this.endNs)));
                return one - other;
            }),
        );
        const largest = roundStep(Math.max(isOfGround ? 1e-3 : 1, ...differences.flat().map(Math.abs)));
        this.drawValues(context, area, [-largest, largest], !isOfGround);
        context.fillStyle = this.faint;
        context.fillRect(left, top + 0.5 * height, width, 1);
        let x = left;
        context.textAlign = "left";
        context.font = `bold 12px ${FONT}`;
        [["A \u2212 B", this.ink], ...curves].forEach(([name, colour], index) => {
            context.fillStyle = colour;
            context.fillText(name, x, top - 6);
            x += context.measureText(name).width + 14;
            if (index === 0) return;
            context.globalAlpha = share;
            context.strokeStyle = colour;
            context.lineWidth = 1.5;
            context.beginPath();
            differences[index - 1].forEach((value, column) => {
                context.lineTo(left + column + 0.5, top + 0.5 * height * (1 - value / largest));
            });
            context.stroke();
            context.globalAlpha = 1;
        });
        context.font = `12px ${FONT}`;
    }

    drawTimes(context, { left, width }, top) {
        const seconds = this.endNs / NANOS;
        const [unit, unitS] = seconds < 300 ? ["s", 1] : ["min", 60];
        const last = seconds / unitS;
        const step = roundStep(last / Math.max(1, width / 60));
        context.fillStyle = this.ink;
        context.textAlign = "center";
        for (let index = 0; index * step <= last * (1 + 1e-9); index++) {
            const x = left + ((index * step) / last) * width;
            context.fillRect(x, top + 2, 1, 4);
            context.fillText(`${Number((index * step).toPrecision(6))}`, x, top + 19);
        }
        context.textAlign = "right";
        context.fillText(unit, left - 14, top + 19);
    }
}
