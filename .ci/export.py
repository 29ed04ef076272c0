"""Reads the exports of one run with the packages of others, and holds them against each other.

Usage: export.py NAME, for NAME.json, NAME.npz, NAME.mcap and, where they are there, NAME.schema.json (what `wildfire schema
export` prints) and NAME.wildfire (the recording, read by docs/output-files.md). Needs the packages mcap and numpy,
and jsonschema for the schemas."""

import base64
import json
import math
import os
import struct
import sys
import zlib

import numpy
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader


def same(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: {found}, expected {expected}")
    print(f"{what}: {str(found)[:80]}")


def check_arrays(run, arrays):
    setting = run["setting"]
    same("scenario", str(arrays["scenario"]), run["scenario"])
    same("seed", int(arrays["seed"]), run["seed"])
    field = arrays["field"]
    same("field", field.shape, (setting["rows"], setting["cols"]))
    same("bushes", [[int(c), int(r)] for r, c in numpy.argwhere(field == 1)], setting["bushes"])
    names = [str(name) for name in arrays["agents"]]
    same("agents", names, [agent["agent"] for agent in setting["agents"]])
    times = arrays["times_s"]
    same("poses", arrays["poses"].shape, (len(names), len(times), 3))
    same("last sample", float(times[-1]), run["ended_ns"] / 1e9)
    starts = [[agent["start"][key] for key in ("x_m", "y_m", "heading_rad")] for agent in setting["agents"]]
    if not any(event["t_ns"] == 0 and event["event"] == "planned" for event in run["events"]):
        same("starts", arrays["poses"][:, 0].tolist(), starts)
    fires = run["fires"]
    ends = sum(fire["ended_ns"] is not None for fire in fires)
    same("changes", len(arrays["change_times_s"]), len(fires) + ends)
    put_out = list(arrays["state_names"]).index("extinguished")
    extinguished = sum(fire["extinguished_by"] is not None for fire in fires)
    same("extinctions", int((arrays["change_states"] == put_out).sum()), extinguished)
    same("legs", len(arrays["leg_agents"]), len(run["legs"]))
    first = arrays["leg_first_pieces"]
    same("pieces", int(first[-1]), sum(len(leg["pieces"]) for leg in run["legs"]))
    # Where an agent is at a sample follows from the pieces of the leg that it follows.
    worst, followed = 0.0, 0
    for leg in range(len(arrays["leg_agents"])):
        inside = (times >= arrays["leg_from_s"][leg]) & (times < arrays["leg_until_s"][leg])
        for sample in numpy.flatnonzero(inside)[:200]:
            pose = arrays["leg_starts"][leg]
            left = times[sample] - arrays["leg_begins_s"][leg]
            for piece in range(first[leg], first[leg + 1]):
                lasts = arrays["piece_lasts_s"][piece]
                if left < 0:
                    break
                pose = along(arrays, piece, min(left, lasts))
                left -= lasts
                if left < 0:
                    break
            found = arrays["poses"][arrays["leg_agents"][leg], sample]
            worst, followed = max(worst, math.dist(pose[:2], found[:2])), followed + 1
    print(f"{followed} poses computed from pieces are off by at most {worst} m")
    if worst > 1e-6:
        sys.exit("poses are not on their legs")


def along(arrays, piece, seconds):
    x, y, heading = arrays["piece_starts"][piece]
    curvature, length, speed, acceleration = arrays["piece_drives"][piece]
    if arrays["piece_motions"][piece] != 0:
        return x, y, heading
    way = min(max(seconds * (speed + 0.5 * acceleration * seconds), 0.0), abs(length)) * math.copysign(1, length)
    half = 0.5 * curvature * way
    chord = way if half == 0 else 2 * math.sin(half) / curvature
    return x + math.cos(heading + half) * chord, y + math.sin(heading + half) * chord, heading + 2 * half


def check_mcap(run, path):
    counts, last, schemas, previous = {}, {}, {}, 0
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        same("profile and library", reader.get_header().profile, "")
        about = {name: value for record in reader.iter_metadata() for name, value in record.metadata.items()}
        same("metadata", (about["scenario"], int(about["seed"])), (run["scenario"], run["seed"]))
        for schema, channel, message in reader.iter_messages():
            data = json.loads(message.data)
            if message.log_time < previous:
                sys.exit(f"{channel.topic}: {message.log_time} comes after {previous}")
            previous = message.log_time
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            last[channel.topic] = data
            schemas[channel.topic] = (schema, data)
        same("messages", sum(counts.values()), summary.statistics.message_count)
        same("topics", len(summary.channels) >= len(counts), True)
        file.seek(0)
        records = sum(1 for _ in StreamReader(file, validate_crcs=True).records)
        print(f"{records} records from front to end, checksums are right")
    grid = last["/cells"]
    cells = base64.b64decode(grid["data"])
    same("bytes of cells", len(cells), 5 * run["setting"]["cols"] * run["setting"]["rows"])
    same("columns", grid["column_count"], run["setting"]["cols"])
    outcome = run["outcome"]
    for name in ("intact", "burning", "burned_out", "extinguished"):
        same(f"{name} at the end", last["/counts"][name], outcome[name])
    states = [cells[5 * (row * grid["column_count"] + col)] for col, row in run["setting"]["bushes"]]
    same("states of bushes", [states.count(state) for state in range(4)],
         [outcome[name] for name in ("intact", "burning", "burned_out", "extinguished")])
    for topic, count in counts.items():
        print(f"{count:8} {topic}")
    try:
        import jsonschema
    except ImportError:
        return
    for topic, (schema, data) in schemas.items():
        jsonschema.validate(data, json.loads(schema.data))
    print("the last message of each topic keeps to its schema")


class Bytes:
    """The primitives of docs/output-files.md."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def unsigned(self):
        number = shift = 0
        while True:
            byte = self.data[self.at]
            self.at += 1
            number |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return number

    def signed(self):
        number = self.unsigned()
        return (number >> 1) ^ -(number & 1)

    def raw(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def byte(self):
        return self.raw(1)[0]

    def float(self):
        return struct.unpack("<d", self.raw(8))[0]

    def floats(self, count):
        return [self.float() for _ in range(count)]

    def bytes(self):
        return self.raw(self.unsigned())

    def text(self):
        return self.bytes().decode()

    def list(self, item):
        return [item() for _ in range(self.unsigned())]

    def maybe(self, item):
        return item() if self.byte() else None

    def is_finished(self):
        return self.at == len(self.data)


class Recording:
    def __init__(self, data):
        magic, self.version, length, crc = struct.unpack("<8sHII", data[:18])
        same("magic", magic, b"WILDFIRE")
        same("length", length, len(data) - 18)
        same("checksum", zlib.crc32(data[18:]), crc)
        payload = Bytes(zlib.decompress(data[18:], -15))
        self.scenario, self.seed, self.program = payload.text(), payload.unsigned(), payload.text()
        self.cols, self.rows, self.cell_m = payload.unsigned(), payload.unsigned(), payload.float()
        self.bushes = self.cells_of(payload.list(payload.unsigned))
        self.agents = payload.list(lambda: self.agent(payload))
        payload.unsigned(), payload.maybe(payload.float), payload.unsigned(), payload.byte(), payload.floats(3)
        facts, delays, records = payload.unsigned(), Bytes(payload.bytes()), Bytes(payload.bytes())
        self.recurring, self.single = payload.list(payload.float), iter(payload.list(payload.float))
        self.references = Bytes(payload.bytes())
        if self.version >= 3:
            payload.list(lambda: payload.maybe(lambda: self.limits(payload)))
            payload.maybe(payload.byte)
            if payload.unsigned():
                payload.unsigned(), payload.float(), payload.raw(2), payload.maybe(payload.unsigned), payload.byte()
        self.log = []
        if self.version >= 7:
            payload.list(payload.unsigned)
            payload.maybe(lambda: self.spread(payload))
            self.log = payload.maybe(lambda: self.read_log(payload)) or []
        if self.version >= 9:
            payload.maybe(lambda: (payload.unsigned(), payload.unsigned(), payload.float(), payload.list(lambda: payload.floats(2))))
        same("payload is read", payload.is_finished(), True)
        self.read_facts(facts, delays, records)

    def cell_at(self, index):
        return [index % self.cols, index // self.cols]

    def cells_of(self, steps):
        index, cells = 0, []
        for step in steps:
            index += step
            cells.append(self.cell_at(index))
        return cells

    def agent(self, payload):
        name = f"{('wumpus', 'unimog')[payload.unsigned()]}/{payload.unsigned()}"
        start = payload.floats(3)
        payload.floats((1, 5, 6)[payload.unsigned()])
        return name, start

    def limits(self, payload):
        payload.floats(2), [payload.maybe(payload.float) for _ in range(3)]

    def spread(self, payload):
        model = payload.unsigned()
        payload.bytes(), payload.bytes()
        relief = payload.unsigned()
        if relief == 0:
            payload.floats(2)
        for _ in range(relief):
            lengths, bits = payload.bytes(), payload.bytes()
            self.differences(lengths, bits, range(self.cols * self.rows))
        payload.list(lambda: (payload.unsigned(), payload.floats(7)))
        if model == 0:
            payload.raw(5), payload.unsigned(), payload.maybe(payload.unsigned)
            payload.maybe(lambda: (payload.unsigned(), payload.floats(9)))
        else:
            payload.floats(4), payload.raw(2), payload.unsigned()

    def differences(self, lengths, bits, indices):
        """Numbers by index, each told by its difference from a prediction."""
        pending, place, last, numbers = int.from_bytes(bits, "little"), 0, 0, {}
        for length, index in zip(lengths, indices, strict=True):
            below = max(length - 1, 0)
            # Slices of the bytes, as shifting all of them for each number would take long.
            window = int.from_bytes(bits[place // 8 : (place + below) // 8 + 1], "little") >> (place % 8)
            folded = (window & ((1 << below) - 1)) | (1 << below) if length else 0
            place += below
            col, row = self.cell_at(index)
            near = [numbers.get(index - 1) if col else None, numbers.get(index - self.cols) if row else None]
            near.append(numbers.get(index - self.cols - 1) if col and row else None)
            if None not in near:
                predicted = near[0] + near[1] - near[2]
            else:
                predicted = next((number for number in near if number is not None), last)
            last = (predicted + ((folded >> 1) ^ -(folded & 1))) % 2**64
            numbers[index] = last
        return numbers

    def read_log(self, payload):
        facts = payload.unsigned()
        stretches, directions = Bytes(payload.bytes()), iter(payload.bytes())
        lengths, bits, records = payload.bytes(), payload.bytes(), Bytes(payload.bytes())
        indices, index, told = [], 0, False
        while not stretches.is_finished():
            stretch = stretches.unsigned()
            indices += range(index, index + stretch) if told else []
            index, told = index + stretch, not told
        times = self.differences(lengths, bits, indices)
        ordinary = []
        for index in indices:
            towards, (col, row) = next(directions), self.cell_at(index)
            ordinary.append((times[index], index, "ground-ignited", [col + towards % 9 - 4, row + towards // 9 - 4]))
        ordinary = iter(sorted(ordinary, key=lambda fact: fact[:2]))
        log, place, time, index = [], 0, 0, 0
        while not records.is_finished():
            place, time = place + records.unsigned(), time + records.unsigned()
            kind, index = records.unsigned(), index + records.signed()
            while len(log) < place:
                log.append(next(ordinary))
            other = None if kind == 3 else records.unsigned()
            if kind == 5:
                other = (other, time + records.unsigned())
            name = "ground-ignited" if kind < 4 else ("ground-extinguished", "wetted")[kind - 4]
            log.append((time, index, name, other))
        log += ordinary
        same("facts of the ground", len(log), facts)
        return log

    def number(self):
        reference = self.references.unsigned()
        return self.recurring[reference - 1] if reference else next(self.single)

    def read_facts(self, count, delays, records):
        self.facts, self.legs, now = [], {}, 0
        u = records.unsigned
        cell_of = lambda n: self.bushes[n] if n < len(self.bushes) else self.cell_at(n - len(self.bushes))

        def cells(count):
            number, found = 0, []
            for _ in range(count):
                number += records.signed()
                found.append(cell_of(number))
            return found

        while len(self.facts) < count:
            now += delays.unsigned()
            kind = u()
            fact = lambda name, **fields: self.facts.append({"t_ns": now, "event": name, **fields})
            if kind in (3, 4, 5, 7, 20):
                cell = cell_of(u())
                if kind == 3:
                    fact("ignited", cell=cell, cause="lit", agent=self.agents[u()][0])
                elif kind == 7:
                    fact("extinguished", cell=cell, agent=self.agents[u()][0])
                elif kind == 5:
                    fact("ignited", cell=cell, cause="schedule")
                else:
                    cause = {"from": cell_of(u()), "cause": "spread" if kind == 4 else "ember"}
                    fact("ignited", cell=cell, **cause)
            elif kind == 6:
                fact("burned-out", cell=cell_of(u()))
            elif kind == 14:
                fact("ended", reason=("duration", "nothing left")[u()])
            elif kind == 19:
                origin, together = cell_of(u()), u()
                for cell in cells(together):
                    fact("ignited", cell=cell, cause="spread", **{"from": origin})
            else:
                place = u()
                self.agent_fact(kind, place, records, now, fact, cell_of, cells)
        ends = [delays.is_finished(), records.is_finished(), self.references.is_finished(), next(self.single, None)]
        same("streams are at their ends", ends, [True, True, True, None])

    def agent_fact(self, kind, place, records, now, fact, cell_of, cells):
        agent, u, number = self.agents[place][0], records.unsigned, self.number
        effort = lambda: {"roadmap_expansions": u(), "local_expansions": u()}
        if kind == 0:
            fact("start-moved", agent=agent, **{"from": dict(zip(("x_m", "y_m", "heading_rad"), [number() for _ in range(3)]))})
        elif kind == 1:
            fact("roadmap-built", agent=agent, samples=u(), edges=u(), components=u())
        elif kind == 2:
            fact("out-of-reach", agent=agent, cells=cells(u()))
        elif kind == 8:
            fields = {"goal": cell_of(u()), **effort()}
            u()
            fact("planned", agent=agent, **fields, leg=self.leg(place, records, now))
        elif kind == 9:
            fields = {"goal": cell_of(u())}
            u()
            fact("plan-failed", agent=agent, **fields, **effort(), until_ns=now + u())
        elif kind == 10:
            fact("dropped", agent=agent, goal=cell_of(u()), leg=self.leg(place, records, now))
        elif kind in (11, 12):
            fact(("suppressing", "suppression-ended")[kind - 11], agent=agent, cell=cell_of(u()))
        elif kind == 13:
            u()
            fact("rested", agent=agent)
        elif kind == 15:
            fact("local-minimum", agent=agent, goal=cell_of(u()), x_m=number(), y_m=number())
        elif kind == 16:
            fact("blocked", agent=agent, goal=cell_of(u()), by=self.agents[u()][0])
        elif kind == 17:
            fact("gave-way", agent=agent, to=self.agents[u()][0], leg=self.leg(place, records, now))
        elif kind == 18:
            phase, places, edges = ("roadmap", "query", "local", "walk")[u()], u(), u()
            fact("searched", agent=agent, phase=phase, **self.graph(places, edges, records))
        elif kind == 21:
            fields = effort()
            u()
            fact("relocated", agent=agent, **fields, x_m=number(), y_m=number(), leg=self.leg(place, records, now))
        elif kind == 22:
            fact("halted", agent=agent, leg=self.leg(place, records, now))
        elif kind == 23:
            u()
            fact("relocation-failed", agent=agent, **effort(), until_ns=now + u(), x_m=number(), y_m=number())
        elif kind == 24:
            fact("refilling", agent=agent, until_ns=now + u())
        else:
            sys.exit(f"kind {kind} is unknown")

    def graph(self, places, edges, records):
        found, last, first = {"edges": [], "places_cm": []}, 0, {}
        for _ in range(edges):
            end = (last + records.signed()) % 2**32
            begin = (end - records.signed()) % 2**32
            found["edges"].append([begin, end])
            if begin < end:
                first.setdefault(end, begin)
            last = end
        for place in range(places):
            near = found["places_cm"]
            x, y = near[first[place]] if place in first else near[-1] if near else (0, 0)
            near.append([x + records.signed(), y + records.signed()])
        return found

    def leg(self, place, records, now):
        u, last = records.unsigned, self.legs.get(place)
        origin, pieces = u(), []
        if origin == 0:
            begins = now + u()
            start = last[2] if last else self.agents[place][1]
            count = u()
        elif origin == 1:
            begins, start = last[0], last[1]
            pieces = last[3][: u()]
            count = u()
        else:
            begins, count = now + records.signed(), u()
            start = [self.number() for _ in range(3)]
        for _ in range(count):
            kind = u()
            pieces = pieces + [(kind, [self.number() for _ in range((4, 1, 1)[kind])])]
        end = start
        for kind, numbers in pieces:
            if kind == 0:
                curvature, length = numbers[:2]
                half = 0.5 * curvature * length
                chord = length if half == 0 else 2 * math.sin(half) / curvature
                heading = math.remainder(end[2] + curvature * length, 2 * math.pi)
                x, y = (turn(end[2] + half) * chord for turn in (math.cos, math.sin))
                end = [end[0] + x, end[1] + y, heading]
            elif kind == 1:
                end = [end[0], end[1], numbers[0]]
        self.legs[place] = (begins, start, end, pieces)
        return self.legs[place]


def check_recording(run, path):
    recording = Recording(open(path, "rb").read())
    setting = run["setting"]
    same("field", (recording.cols, recording.rows, recording.cell_m), (setting["cols"], setting["rows"], setting["cell_m"]))
    same("bushes of the recording", recording.bushes, setting["bushes"])
    same("facts", len(recording.facts), len(run["events"]))
    worst, legs = 0.0, 0
    for found, expected in zip(recording.facts, run["events"]):
        leg = found.pop("leg", None)
        if any(expected[key] != value for key, value in found.items()):
            sys.exit(f"{found}, expected {expected}")
        if leg is None or expected["leg"] is None:
            continue
        of_json = run["legs"][expected["leg"]]
        begins, start, _, pieces = leg
        begins_right = begins == of_json["begins_ns"] and len(pieces) == len(of_json["pieces"])
        for (kind, numbers), piece in zip(pieces, of_json["pieces"]):
            if kind == 0:
                names = ("curvature", "length_m", "speed_mps", "acceleration_mps2")
                begins_right &= numbers == [piece[name] for name in names]
        if not begins_right:
            sys.exit(f"leg {leg}, expected {of_json}")
        worst, legs = max(worst, math.dist(start[:2], (of_json["start"]["x_m"], of_json["start"]["y_m"]))), legs + 1
    print(f"{legs} legs are the same, their starts to {worst} m")
    if worst > 1e-6:
        sys.exit("legs begin elsewhere")
    ignited = [fact for fact in recording.log if fact[2] == "ground-ignited" and fact[0] <= run["ended_ns"]]
    fires = [fire for fire in run["fires"] if fire["ground"]]
    same("fires of ground", len(ignited), len(fires))
    key = lambda fire: (fire["ignited_ns"], fire["cell"][1], fire["cell"][0])
    expected = sorted((*key(fire), fire.get("from")) for fire in fires if fire["cause"] == "spread")
    spread = sorted((time, index // recording.cols, index % recording.cols, other)
                    for time, index, _, other in ignited if isinstance(other, list))
    same("fires that spread to ground, or some of them", set(map(str, spread)) <= set(map(str, map(tuple, expected))), True)


name = sys.argv[1]
with open(f"{name}.json") as file:
    run = json.load(file)
if os.path.exists(f"{name}.schema.json"):
    import jsonschema

    jsonschema.validate(run, json.load(open(f"{name}.schema.json")))
    print("the object keeps to its schema")
with numpy.load(f"{name}.npz") as arrays:
    check_arrays(run, {key: arrays[key] for key in arrays.files})
check_mcap(run, f"{name}.mcap")
if os.path.exists(f"{name}.wildfire"):
    check_recording(run, f"{name}.wildfire")
print("all exports agree")
