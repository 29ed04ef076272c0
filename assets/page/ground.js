// Ground that burns: vegetation, the spread of fire, wet cells, embers, lines of equal arrival time, the wind.

const MILLIS = 1e6;
// The flight of an ember is shown for this long after it has lit a fire.
const FLIGHT_LASTS_NS = 60e9;

const COMPASS = ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

// The ground of a run at any time, with a pixel for each cell, the north row first.
class Ground {
    constructor(run, data) {
        Object.assign(this, { run, shades: data.shades, fire: data.colours, cells: data.cells });
        this.covers = this.paint(this.colourTable(data.covers));
        for (const shades of Object.values(data.shades)) shades.byCell = this.colourTable(shades.cells);
        this.burnings = Ground.burnings(data.burnings);
        this.ignitions = Float64Array.from(this.burnings, ({ ignitedNs }) => ignitedNs);
        this.ends = Float64Array.from(this.burnings, ({ endsNs }) => endsNs).sort();
        this.firsts = Float64Array.from(this.burnings.filter(({ isFirst }) => isFirst), ({ ignitedNs }) => ignitedNs);
        const [cells, from] = [sums(data.wettings.cell), sums(data.wettings.from_ms)];
        this.wettings = Array.from(cells, (cell, index) => {
            const fromNs = from[index] * MILLIS;
            return { cell, fromNs, untilNs: fromNs + data.wettings.lasts_ms[index] * MILLIS };
        });
        this.spotTimes = sums(data.spots.time_ms).map((time) => time * MILLIS);
        this.spots = data.spots;
        this.arrival = data.arrival.map(({ time_s, label, lines }) => ({ timeNs: time_s * NANOS, label, lines: lines.map((line) => sums(line, 2)) }));
        // A module of a page that was built before has no crews.
        this.crews = Float64Array.from(data.crews_ms ?? [], (time) => time * MILLIS);
        // When which cell was cleared, and whether it holds.
        const line = data.line ?? { cell: [], from_ms: [], holds: [] };
        this.line = { times: sums(line.from_ms).map((time) => time * MILLIS), cells: line.cell, holds: line.holds };
        this.wind = { times: Float64Array.from(data.wind.from_ms, (time) => time * MILLIS), east: data.wind.east, north: data.wind.north };
        this.sheet = this.makeSheet();
        this.picture = this.sheet.getContext("2d").createImageData(run.cols, run.rows);
        this.reset(null);
    }

    // In order of time.
    static burnings(table) {
        const [cells, ignited] = [sums(table.cell), sums(table.ignited_ms)];
        const burnings = Array.from(cells, (cell, index) => {
            const ignitedNs = ignited[index] * MILLIS;
            const lasts = table.lasts_ms[index];
            const endsNs = lasts < 0 ? Infinity : ignitedNs + lasts * MILLIS;
            return { cell, ignitedNs, endsNs, isPutOut: table.is_put_out[index] === 1, isFirst: cell !== cells[index - 1] };
        });
        return burnings.sort((one, other) => one.ignitedNs - other.ignitedNs);
    }

    makeSheet() {
        return Object.assign(document.createElement("canvas"), { width: this.run.cols, height: this.run.rows });
    }

    colourTable({ colours, cells }) {
        const known = colours.map(rgb);
        return cells.map((place) => known[place] ?? null);
    }

    paint(colours) {
        const sheet = this.makeSheet();
        const picture = sheet.getContext("2d").createImageData(sheet.width, sheet.height);
        colours.forEach((colour, cell) => this.put(picture, cell, colour, 255));
        sheet.getContext("2d").putImageData(picture, 0, 0);
        return sheet;
    }

    put(picture, cell, colour, opacity) {
        if (colour === null) return;
        const { cols, rows } = this.run;
        const at = 4 * ((rows - 1 - Math.floor(cell / cols)) * cols + (cell % cols));
        [picture.data[at], picture.data[at + 1], picture.data[at + 2]] = colour;
        picture.data[at + 3] = opacity;
    }

    reset(shades) {
        this.picture.data.fill(0);
        // Burnings whose colour still changes, and how many have begun.
        Object.assign(this, { changing: [], begun: 0, shown: shades, now: 0 });
    }

    // Moves the picture of the fire to a time, in the colours of a layer if there is one.
    seek(ns, shades) {
        if (ns < this.now || shades !== this.shown) this.reset(shades);
        const until = lastAt(this.ignitions, ns) + 1;
        for (; this.begun < until; this.begun++) this.changing.push(this.burnings[this.begun]);
        const opacity = Math.round(255 * this.fire.burned_opacity);
        for (const burning of this.changing) {
            const shade = shades?.byCell[burning.cell];
            this.put(this.picture, burning.cell, shade ?? this.colourOf(burning, ns), shade ? 255 : opacity);
        }
        this.changing = this.changing.filter(({ endsNs }) => ns < endsNs + this.fire.glows_for_s * NANOS);
        this.now = ns;
        this.sheet.getContext("2d").putImageData(this.picture, 0, 0);
    }

    colourOf({ ignitedNs, endsNs, isPutOut }, ns) {
        const { fire } = this;
        const [age, sinceEnd] = [(ns - ignitedNs) / NANOS, (ns - endsNs) / NANOS];
        if (sinceEnd >= 0 && isPutOut) return fire.put_out;
        if (sinceEnd >= 0) return blend(fire.embers, fire.char, Math.min(1, sinceEnd / fire.glows_for_s));
        if (age < fire.young_for_s) return blend(fire.young, fire.flaming, Math.max(0, age / fire.young_for_s));
        return blend(fire.flaming, fire.old, Math.min(1, (age - fire.young_for_s) / fire.old_after_s));
    }

    // Hectares burning now, and hectares burned or burning.
    hectaresAt(ns) {
        const perCell = this.run.cell_m ** 2 / 1e4;
        const burning = lastAt(this.ignitions, ns) - lastAt(this.ends, ns);
        return { burning: burning * perCell, burned: (lastAt(this.firsts, ns) + 1) * perCell };
    }

    // The length of the edge of what has burned. A straight front across square cells is a staircase, 4 / pi times as long
    // averaged over its directions.
    perimeterAt(ns) {
        this.edges ??= this.countEdges();
        return (0.25 * Math.PI * this.run.cell_m * (this.edges[lastAt(this.firsts, ns)] ?? 0));
    }

    // Sides of cells between burned and other ground after each first ignition.
    countEdges() {
        const { cols, rows } = this.run;
        const burned = new Set();
        let edges = 0;
        return this.burnings.filter(({ isFirst }) => isFirst).map(({ cell }) => {
            const [col, row] = [cell % cols, Math.floor(cell / cols)];
            const beside = [col > 0 && cell - 1, col + 1 < cols && cell + 1, row > 0 && cell - cols, row + 1 < rows && cell + cols];
            edges += 4 - 2 * beside.filter((other) => other !== false && burned.has(other)).length;
            burned.add(cell);
            return edges;
        });
    }

    windAt(ns) {
        const interval = lastAt(this.wind.times, ns);
        return [this.wind.east[interval], this.wind.north[interval]];
    }
}

Object.assign(FieldPane.prototype, {
    // Lays a sheet of one pixel a cell over the field.
    layCells(context, sheet) {
        const { run, projection } = this;
        const [left, top] = projection.at({ x: 0, y: run.heightM });
        context.imageSmoothingEnabled = false;
        context.drawImage(sheet, left, top, run.widthM * projection.scale, run.heightM * projection.scale);
        context.imageSmoothingEnabled = true;
    },

    drawGroundFire() {
        const { run, ns, context, projection } = this;
        run.ground.seek(ns, this.groundShades());
        this.layCells(context, run.ground.sheet);
        if (projection.cellSide < 1) this.drawSmallFires();
        if (this.shows("wet")) this.drawWet();
        if (projection.cellSide >= MIN_SPRITE) this.drawBushes(context);
        if (this.shows("arrival")) this.drawArrivalLines();
        if (this.shows("embers")) this.drawEmbers();
    },

    // Every cell that burns as four pixels, so that none is passed over.
    drawSmallFires() {
        const { run, ns, context, projection } = this;
        for (const burning of run.ground.changing) {
            if (ns >= burning.endsNs) continue;
            const [x, y] = projection.at(run.cellCentre(burning.cell)).map(Math.round);
            context.fillStyle = css(run.ground.colourOf(burning, ns));
            context.fillRect(x - 1, y - 1, 2, 2);
        }
    },

    drawWet() {
        const { run, ns, context, projection } = this;
        const wet = run.ground.wettings.filter(({ fromNs, untilNs }) => fromNs <= ns && ns < untilNs);
        context.fillStyle = css(run.ground.fire.wet, run.ground.fire.wet_opacity);
        for (const cell of new Set(wet.map((wetting) => wetting.cell))) {
            const [left, top, right, bottom] = projection.cell(run.cell(cell));
            context.fillRect(left, top, right - left, bottom - top);
        }
        const { times, cells, holds } = run.ground.line;
        for (let index = 0; index <= lastAt(times, ns); index++) {
            const [left, top, right, bottom] = projection.cell(run.cell(cells[index]));
            context.fillStyle = css(holds[index] ? run.ground.fire.line : run.ground.fire.lost_line);
            context.fillRect(left, top, right - left, bottom - top);
        }
    },

    // The lines that the fire has reached so far, at round times.
    drawArrivalLines() {
        const { run, ns, context, projection, unit, colours } = this;
        const place = (line, index) =>
            projection.at({ x: (line[2 * index] / 100 + 0.5) * run.cell_m, y: (line[2 * index + 1] / 100 + 0.5) * run.cell_m });
        for (const { timeNs, label, lines } of run.ground.arrival) {
            if (timeNs > ns) continue;
            let [longest, longestLength] = [null, 0];
            for (const line of lines) {
                const points = Array.from({ length: line.length / 2 }, (_, index) => place(line, index));
                this.line(context, points, css(rgb(colours.ink), 0.5), 2.6 * unit);
                this.line(context, points, colours.paper, 1.3 * unit);
                const length = points.reduce((sum, [x, y], at) => (at === 0 ? 0 : sum + Math.hypot(x - points[at - 1][0], y - points[at - 1][1])), 0);
                if (length > longestLength) [longest, longestLength] = [points, length];
            }
            if (longest === null || longestLength <= 90 * unit) continue;
            const [x, y] = longest[Math.floor(longest.length / 2)];
            const size = 8 * unit;
            context.font = this.font(size);
            context.textAlign = "center";
            context.lineWidth = 0.4 * size;
            context.lineJoin = "round";
            context.strokeStyle = colours.ink;
            context.strokeText(label, x, Math.round(y + 0.5 * size));
            this.write(label, [x, y + 0.5 * size], "center", size, colours.paper);
        }
    },

    // Fires lit by embers, and for a while their origins.
    drawEmbers() {
        const { run, ns, context, projection, unit, colours } = this;
        const ember = run.ground.fire.ember;
        for (let index = 0; index <= lastAt(run.ground.spotTimes, ns); index++) {
            const [at, from] = [run.ground.spots.at_m[index], run.ground.spots.from_m[index]].map(([x, y]) => projection.at({ x, y }));
            const age = ns - run.ground.spotTimes[index];
            if (age < FLIGHT_LASTS_NS) this.line(context, [from, at], css(ember, 0.8 * (1 - age / FLIGHT_LASTS_NS)), 1.4 * unit);
            if (!this.isNear(at, 8 * unit)) continue;
            const radius = clamp(0.6 * projection.cellSide, 3 * unit, 9 * unit);
            this.ring(context, at, radius, colours.ink, 2.6 * unit);
            this.ring(context, at, radius, css(ember), 1.5 * unit);
        }
    },

    // An arrow along which the wind blows, its speed, and where it comes from, at the upper right.
    drawWind() {
        const { run, ns, context, unit, colours, canvas } = this;
        const [east, north] = run.ground.windAt(ns);
        const speed = Math.hypot(east, north);
        const [margin, padding, text, dial] = [10, 7, 8, 17].map((length) => length * unit);
        const isCalm = speed < 0.05;
        const azimuth = (Math.atan2(-east, -north) * 360) / TAU;
        const point = COMPASS[(((Math.round(azimuth / 22.5) % 16) + 16) % 16)];
        const words = isCalm ? ["calm"] : [`${speed.toFixed(1)} m/s`, `from ${point}`];
        context.font = this.font(text);
        const widest = ["from WNW", "88.8 m/s"].map((longest) => context.measureText(longest).width);
        const width = 2 * padding + Math.max(2 * dial, ...widest);
        const height = 2 * dial + 3 * padding + 2.7 * text;
        const [left, top] = [canvas.width - margin - width, margin];
        context.fillStyle = css(rgb(colours.paper), 0.85);
        context.fillRect(left, top, width, height);
        const centre = [left + 0.5 * width, top + padding + dial];
        this.disc(context, centre, dial, colours.faint);
        this.disc(context, centre, dial - unit, colours.paper);
        context.fillStyle = colours.ink;
        context.fillRect(Math.round(centre[0] - 0.75 * unit), Math.round(centre[1] - dial), Math.round(1.5 * unit), Math.round(4 * unit));
        if (!isCalm) {
            const [right, up, half] = [east / speed, north / speed, 0.78 * dial];
            const arrow = [[-1, -0.13], [0.15, -0.13], [0.15, -0.5], [1, 0], [0.15, 0.5], [0.15, 0.13], [-1, 0.13]];
            const at = ([forward, left]) => [centre[0] + half * (forward * right + left * up), centre[1] - half * (forward * up - left * right)];
            this.area(context, arrow.map(at), colours.ink);
        }
        words.forEach((word, line) => {
            this.write(word, [centre[0], top + 2 * (padding + dial) + text * (0.9 + 1.5 * line)], "center", text, colours.ink);
        });
    },

    // The colours of the first layer shown by which the ground is painted; null without one.
    groundShades() {
        const shown = Object.entries(this.run.ground.shades).find(([layer]) => this.shows(layer));
        return shown?.[1] ?? null;
    },

    // A bar of colours with round values, at the lower right.
    drawShadesBar() {
        const { context, unit, colours, canvas } = this;
        const { name, shades, ticks } = this.groundShades();
        const [margin, text, padding] = [10, 8, 6].map((length) => length * unit);
        const [barWidth, barHeight, mark] = [12, 110, 4].map((length) => Math.round(length * unit));
        context.font = this.font(text);
        const wide = (label) => context.measureText(label).width;
        const labels = Math.max(0, ...ticks.map(([, label]) => wide(label)));
        const width = Math.max(wide(name), barWidth + 2 * mark + labels) + 2 * padding;
        const height = barHeight + 2 * text + 4 * padding;
        const [right, bottom] = [canvas.width - margin, canvas.height - margin];
        context.fillStyle = css(rgb(colours.paper), 0.85);
        context.fillRect(right - width, bottom - height, width, height);
        const [left, top] = [Math.round(right - width + padding), Math.round(bottom - padding - 0.5 * text - barHeight)];
        this.write(name, [left, bottom - height + padding + text], "left", text, colours.ink);
        for (let row = 0; row < barHeight; row++) {
            const share = 1 - (row + 0.5) / barHeight;
            context.fillStyle = shades[Math.min(Math.floor(share * shades.length), shades.length - 1)];
            context.fillRect(left, top + row, barWidth, 1);
        }
        for (const [share, label] of ticks) {
            const y = top + barHeight * (1 - share);
            context.fillStyle = colours.ink;
            context.fillRect(left + barWidth, Math.round(y - 0.5 * unit), mark, Math.round(unit));
            this.write(label, [left + barWidth + 2 * mark, y + 0.5 * text], "left", text, colours.ink);
        }
    },
});
