"""A second referee for recordings of the contest: `python verify.py RECORDING|FOLDER..`

This file needs nothing but Python 3.9 and shares no code with the program or its audit. It was written from two pages of
the guide, "The format of recordings" and "Audit". It checks again:

- bodies of trucks and Wumpuses against bushes, blocked cells and the edge along their whole paths; trucks against trucks
- turning radius, speeds and accelerations; that legs begin where and when their agent rests, or replace what was driven
- stops: arrival, standing still, dwell, reach; what a stop extinguishes, and when
- fires under the model `radius`: every ignition, spread and burn-out to the nanosecond, and that none is missing
- the end of the run; in the folder of a batch also the states, causes, scores and winner in `runs.csv`

The reach of Wumpuses and the scenario's own ignitions are not part of a recording: only the arrival of a Wumpus is
checked. Ground that burns, water, crews and steering rates are listed as not checked. Units are metres, seconds and
radians unless a name ends in `_ns`; headings are counter-clockwise from east.

Exit codes: 0 no violation, 2 a file that cannot be read, 4 a violation.
"""

import argparse
import bisect
import csv
import glob
import itertools
import math
import os
import re
import struct
import sys
import zlib
from collections import deque, namedtuple

MAX_PAYLOAD_BYTES = 65_554_432
MAX_SIDE, MAX_AGENTS, MAX_FACTS, MAX_PIECES = 4096, 2000, 2_000_000, 2_000_000
MAX_BUSHES = 1_000_000  # of the memory of this program, not of the format
# A file may describe more driving or fire than anybody waits for. This is a hundred times the work of a large run.
MAX_WORK = 50_000_000
DEPTH_M = 0.001  # the depth to which bodies may overlap: the tolerance in docs/audit.md
POSE_M = 1e-5  # the difference by rounding between two descriptions of a pose
SPEED_MPS = 1e-3  # the difference by rounding between the speeds of consecutive pieces
RELATIVE = 1e-6  # the share by which rounding exceeds a limit
MAX_PRINTED = 20

REPLACING = (10, 17, 22)  # kinds of facts whose leg replaces the previous one
DRIVE, TURN, STAND = range(3)
INTACT, BURNING, BURNED_OUT, EXTINGUISHED = range(4)
LIT, SPREAD, SCHEDULE = range(3)

Body = namedtuple("Body", "is_square length width wheelbase overhang radius has_steering_rate")
Agent = namedtuple("Agent", "name is_truck start body")
Rules = namedtuple("Rules", "duration_ns reach dwell_ns relight ignited burned_out extinguished")
Fires = namedtuple("Fires", "delay_ns radius lit_spreads caught_spreads burn_out_ns relight")
Limits = namedtuple("Limits", "forward reverse acceleration braking lateral")
Fact = namedtuple("Fact", "t_ns kind values leg")  # values: the fields, with cells as indices of cells
Leg = namedtuple("Leg", "start pose begins_ns shared pieces")  # start: how it is given, from 0 to 2
Recording = namedtuple("Recording", "scenario seed cols rows cell bushes agents rules facts end_ns limits one_at_a_stop fires "
                       "piece_of blocked has_ground unchecked")
Piece = namedtuple("Piece", "kind from_s lasts pose end curvature length speed last acceleration")
Path = namedtuple("Path", "begins_ns ends_ns pieces starts_s")  # the first piece of a path stands for no time


class Unreadable(Exception):
    """A file that is not a recording of version 9, or that breaks a guarantee of its format."""


def need(condition, message):
    if not condition:
        raise Unreadable(message)


class Report:
    """The violations of a recording as (time in ns, x, y, agent or "", sentence), and the work done."""

    def __init__(self):
        self.violations, self.work = [], 0

    def add(self, t_ns, place, name, text):
        self.violations.append((t_ns, place[0], place[1], name, text))

    def spend(self, work):
        self.work += work
        need(self.work <= MAX_WORK, "it describes more driving or fire than can be checked")


class Bytes:
    """A cursor over bytes in postcard's format."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        need(count <= len(self.data) - self.at, "it ends in the middle of a value")
        self.at += count
        return self.data[self.at - count : self.at]

    def unsigned(self, bits=32):
        value, shift, more = 0, 0, True
        while more:
            need(shift < 64, "a number has too many bytes")
            byte = self.take(1)[0]
            value, shift, more = value | (byte & 127) << shift, shift + 7, byte > 127
        need(value >> bits == 0, "a number is too large")
        return value

    def signed(self, bits=32):
        folded = self.unsigned(bits)
        return folded >> 1 if folded % 2 == 0 else -(folded >> 1) - 1

    def choice(self, count):
        value = self.unsigned()
        need(value < count, "a choice has an unknown number")
        return value

    def flag(self):
        return self.choice(2) == 1

    def numbers(self, count):
        values = struct.unpack(f"<{count}d", self.take(8 * count))
        need(all(map(math.isfinite, values)), "a number is not finite")
        return values

    def number(self):
        return self.numbers(1)[0]

    def optional(self, read):
        return read() if self.flag() else None

    def block(self):
        return self.take(self.unsigned())

    def rising_cells(self, cell_count):
        count = self.unsigned()
        need(count <= MAX_BUSHES, "it has more than a million bushes")
        cells = list(itertools.accumulate(self.unsigned() for _ in range(count)))
        need(cells[-1:] < [cell_count] and len(set(cells)) == count, "a list of cells repeats one or leaves the field")
        return cells


def read_payload(path):
    """Returns the inflated payload of a file; raises Unreadable for a wrong header, checksum or stream, or OSError."""
    with open(path, "rb") as file:
        head = file.read(18)
        need(len(head) == 18 and head[:8] == b"WILDFIRE", "it is not a recording")
        version, size, checksum = struct.unpack("<HII", head[8:])
        need(version == 9, f"its format is version {version}; version 9 can be checked")
        stored = file.read(min(size, MAX_PAYLOAD_BYTES) + 1)
    need(len(stored) == size and zlib.crc32(stored) == checksum, "its length or its checksum is wrong")
    inflater = zlib.decompressobj(-15)
    try:
        payload = inflater.decompress(stored, MAX_PAYLOAD_BYTES)
    except zlib.error as error:
        raise Unreadable(f"its payload does not inflate: {error}") from None
    need(inflater.eof and not inflater.unused_data, "its payload is too large, or ends before the file")
    return payload


def read_agent(data):
    is_truck, number = data.choice(2) == 1, data.unsigned(16)
    start, kind = data.numbers(3), data.choice(3)
    sizes = data.numbers((1, 5, 6)[kind])
    body = Body(False, *sizes[:5], kind == 2) if kind else Body(True, sizes[0], sizes[0], 0.0, sizes[0] / 2, 1.0, False)
    need(0 < body.length <= 100 and 0 < body.width <= 100 and 0 <= body.overhang <= body.length and body.radius > 0
         and is_truck != body.is_square, "an agent has an impossible body")
    return Agent(f"{'unimog' if is_truck else 'wumpus'}/{number}", is_truck, start, body)


# The fields of each kind of fact: a agent, c cell, u and w numbers of 32 and 64 bits, s list of cells, n number by
# reference, l leg, g graph.
FIELDS = "annn auuu as ca cc c c ca acuuul acuuuw acl ac ac au u acnn aca aal auuug cs cc auuunnl al auuuwnn aw acu".split()


def read_facts(data, bushes, agent_count, cell_count):
    """Reads the streams and returns the facts in order of time."""
    count, delays, records = data.unsigned(), Bytes(data.block()), Bytes(data.block())
    need(count <= MAX_FACTS, "it has more than two million facts")
    recurring, unread = data.numbers(data.unsigned()), deque(data.numbers(data.unsigned()))
    references = Bytes(data.block())
    facts, t_ns, pieces, total, length_of = [], 0, 0, 0, {}

    def number():
        reference = references.unsigned()
        need(reference <= len(recurring) and (reference or unread), "a number is missing")
        return recurring[reference - 1] if reference else unread.popleft()

    def named_cell(index):
        need(0 <= index < len(bushes) + cell_count, "a fact names a cell outside the field")
        return bushes[index] if index < len(bushes) else index - len(bushes)

    def cells():
        return [named_cell(index) for index in itertools.accumulate(records.signed() for _ in range(records.unsigned()))]

    def leg():
        start = records.choice(3)
        begins_ns = t_ns + (records.unsigned(64) if start == 0 else records.signed(64) if start == 2 else 0)
        shared = records.unsigned() if start == 1 else 0
        new = records.unsigned()
        need(shared <= length_of.get(values[0], 0), "a leg shares more pieces than the last one has")
        need(pieces + shared + new <= MAX_PIECES, "it has more than two million pieces of legs")
        length_of[values[0]] = shared + new
        pose = tuple(number() for _ in range(3)) if start == 2 else None
        kinds = (records.choice(3) for _ in range(new))
        return Leg(start, pose, begins_ns, shared, [(kind, [number() for _ in range((4, 1, 1)[kind])]) for kind in kinds])

    readers = {"a": lambda: records.choice(agent_count), "c": lambda: named_cell(records.unsigned()), "u": records.unsigned,
               "w": lambda: records.unsigned(64), "s": cells, "n": number, "l": leg,
               "g": lambda: sum(records.signed() for _ in range(2 * (values[2] + values[3])))}
    while delays.at < len(delays.data):
        t_ns += delays.unsigned(64)
        kind, values = records.choice(len(FIELDS)), []
        values.extend(readers[field]() for field in FIELDS[kind])
        its_leg = values.pop() if FIELDS[kind].endswith("l") else None
        facts.append(Fact(t_ns, kind, values, its_leg))
        pieces += length_of[values[0]] if its_leg else 0
        total += len(values[1]) if kind == 19 else 1
        need(total <= count, "it has more facts than it states")
    left = len(records.data) - records.at + len(references.data) - references.at + len(unread)
    need(left == 0 and total == count > 0, "its streams do not end together")
    return facts


def read_recording(path):
    """Reads a recording; raises Unreadable or OSError."""
    data = Bytes(read_payload(path))
    scenario, seed, _version = data.block().decode("utf-8", "replace"), data.unsigned(64), data.block()
    cols, rows, cell = data.unsigned(16), data.unsigned(16), data.number()
    need(1 <= cols <= MAX_SIDE and 1 <= rows <= MAX_SIDE and 0.001 <= cell <= 1e5, "its field has impossible dimensions")
    bushes, agent_count = data.rising_cells(cols * rows), data.unsigned()
    need(agent_count <= MAX_AGENTS, "it has more than 2000 agents")
    agents = [read_agent(data) for _ in range(agent_count)]
    duration_ns, reach, dwell_ns = data.unsigned(64), data.optional(data.number), data.unsigned(64)
    rules = Rules(duration_ns, math.inf if reach is None else reach, dwell_ns, data.flag(), *data.numbers(3))
    facts = read_facts(data, bushes, agent_count, cols * rows)
    limits_count = data.unsigned()
    need(limits_count <= agent_count, "it has more limits than agents")
    limits = [data.optional(lambda: Limits(*data.numbers(2), *(data.optional(data.number) for _ in range(3))))
              for _ in range(limits_count)] + [None] * (agent_count - limits_count)
    extinguishes_all, fire_rules, fires, piece_of = data.optional(data.flag), data.choice(3), None, {}
    if fire_rules:
        fires = Fires(data.unsigned(64), data.number(), data.flag(), data.flag(),
                      data.optional(lambda: data.unsigned(64)), data.flag())
    if fire_rules == 2:
        need(data.unsigned() == len(bushes), "it does not have a piece for each bush")
        members = {}
        for bush in bushes:
            piece_of[bush] = members.setdefault(data.unsigned(), [])
            piece_of[bush].append(bush)
    blocked, others, unchecked = data.rising_cells(cols * rows), data.data[data.at :], []
    has_ground = others[:1] != b"\0"  # what follows: ground, ground log, water, each 0 if there is none, and more parts
    if has_ground or others != bytes(3):
        unchecked.append("ground that burns: fires, stops, results" if has_ground else "water, speeds by ground, crews, dwell")
        rules = rules._replace(dwell_ns=None)
    if fires is None or extinguishes_all is None or None in limits:
        unchecked.append("rules of fire and stops, or speed limits, that it does not state")
    if any(agent.body.has_steering_rate for agent in agents):
        unchecked.append("rates of steering")
    return Recording(scenario, seed, cols, rows, cell, bushes, agents, rules, facts, facts[-1].t_ns, limits,
                     extinguishes_all is False, fires, piece_of, blocked, has_ground, unchecked)


def wrapped(angle):
    return math.pi - (math.pi - angle) % (2 * math.pi)


def along(pose, curvature, length):
    """Returns the pose after a drive of `length` metres, negative in reverse, along an arc."""
    x, y, heading = pose
    half = curvature * length / 2
    chord = length if half == 0 else 2 * math.sin(half) / curvature
    return x + math.cos(heading + half) * chord, y + math.sin(heading + half) * chord, wrapped(heading + 2 * half)


def standing(pose):
    return Piece(STAND, 0.0, 0.0, pose, pose, 0.0, 0.0, 0.0, 0.0, 0.0)


def build_path(leg, old):
    """Returns the path of a leg; its agent was on the path `old` before."""
    pieces = [standing(old.pieces[-1].end if leg.start == 0 else leg.pose)]
    if leg.start == 1:
        pieces = old.pieces[: leg.shared + 1]
    for kind, numbers in leg.pieces:
        need(max(map(abs, numbers)) < 1e9, "a piece of a leg never ends")
        pose, from_s = pieces[-1].end, pieces[-1].from_s + pieces[-1].lasts
        if kind == DRIVE:
            curvature, length, speed, acceleration = numbers
            last = math.sqrt(max(0.0, speed * speed + 2 * acceleration * abs(length)))
            lasts = 2 * abs(length) / (speed + last) if speed + last > 0 else math.inf if length else 0.0
            end = along(pose, curvature, length)
            pieces.append(Piece(DRIVE, from_s, lasts, pose, end, curvature, length, speed, last, acceleration))
        else:
            end = (pose[0], pose[1], wrapped(numbers[0])) if kind == TURN else pose
            pieces.append(standing(pose)._replace(kind=kind, from_s=from_s, lasts=numbers[0] if kind == STAND else 0.0, end=end))
        need(0 <= pieces[-1].lasts < 1e9, "a piece of a leg never ends")
    begins_ns = old.begins_ns if leg.start == 1 else leg.begins_ns
    # The end of a leg is the next nanosecond, and sums of seconds are not exact.
    ends_ns = begins_ns + math.ceil((pieces[-1].from_s + pieces[-1].lasts) * 1e9 - 1e-3)
    return Path(begins_ns, ends_ns, pieces, [piece.from_s for piece in pieces])


def pose_at(path, t_ns):
    """Returns the pose on a path at a time; before and after it that of its beginning and of its end."""
    if t_ns <= path.begins_ns or t_ns >= path.ends_ns:
        return path.pieces[-1].end if t_ns >= path.ends_ns else path.pieces[0].pose
    after_s = (t_ns - path.begins_ns) * 1e-9
    piece = path.pieces[bisect.bisect_right(path.starts_s, after_s) - 1]
    after_s = min(after_s - piece.from_s, piece.lasts)
    way = min(piece.speed * after_s + piece.acceleration * after_s * after_s / 2, abs(piece.length))
    return along(piece.pose, piece.curvature, math.copysign(way, piece.length))


def apart(a, b, agent):
    """Returns the distance of two poses, metres and radians alike; the square of a Wumpus has no direction."""
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(wrapped(a[2] - b[2])) if agent.is_truck else 0.0)


def check_pieces(report, agent, limits, path, first):
    """Checks curvature and speeds of the pieces of a path, from number `first` on."""
    limits = limits or Limits(None, None, None, None, None)
    jump_limit = SPEED_MPS if limits.acceleration or limits.braking else None
    before = 0.0  # the speed at which the previous piece ends, negative in reverse

    def check(value, limit, what):
        if limit is not None and value > limit * (1 + RELATIVE):
            report.add(path.begins_ns + round(piece.from_s * 1e9), piece.pose, agent.name,
                       f"{what} is {value:.6f}, more than {limit:.6f}")

    for number, piece in enumerate(path.pieces[1:], 1):
        check(int(piece.kind == TURN and agent.is_truck), 0, "the number of its turns on the spot")
        if piece.kind == TURN or (piece.kind == DRIVE and not piece.length):
            continue
        sign, fastest = math.copysign(1.0, piece.length), max(piece.speed, piece.last)
        jump, before = abs(sign * piece.speed - before), sign * piece.last
        if number <= first:
            continue
        check(jump, jump_limit, "a jump of its speed")
        check(-piece.speed, 0, "its speed against its direction")
        check(-piece.speed**2 - 2 * piece.acceleration * abs(piece.length), SPEED_MPS, "its braking beyond a standstill")
        check(abs(piece.curvature), 1 / agent.body.radius if agent.is_truck else 0, "its curvature")
        check(fastest, limits.forward if piece.length > 0 else limits.reverse, "its speed")
        check(piece.acceleration, limits.acceleration, "its acceleration")
        check(-piece.acceleration, limits.braking, "its braking")
        check(fastest**2 * abs(piece.curvature), limits.lateral, "its lateral acceleration")
    piece = path.pieces[-1]
    check(abs(before), jump_limit, "its speed at the end of a leg")


def follow_legs(recording, report):
    """Checks every leg against the one before; returns the paths that each agent drove, in order of time."""
    tracks = [[Path(0, 0, [standing(agent.start)], [0.0])] for agent in recording.agents]
    for t_ns, kind, values, leg in recording.facts:
        if leg is None:
            continue
        agent, track = recording.agents[values[0]], tracks[values[0]]
        old, new = track[-1], build_path(leg, track[-1])
        if kind in REPLACING and new.begins_ns < t_ns:
            # Two arcs from one pose agree everywhere if they agree at the middle and the end of each piece.
            times = [new.begins_ns + round((piece.from_s + piece.lasts * part) * 1e9)
                     for piece in new.pieces[leg.shared :] for part in (0, 0.5, 1)]
            times = [t_ns] + [time for time in times if time <= t_ns]
            if new.begins_ns != old.begins_ns or any(apart(pose_at(old, t), pose_at(new, t), agent) > POSE_M for t in times):
                report.add(t_ns, pose_at(old, t_ns), agent.name, "its aborted leg was not driven as planned")
            track.pop()
        else:
            unbegun = kind in REPLACING and old.begins_ns >= t_ns
            rests_ns, rests_at = (0, old.pieces[0].pose) if unbegun else (old.ends_ns, old.pieces[-1].end)
            early_ns, off = max(rests_ns - 1, t_ns) - new.begins_ns, apart(new.pieces[0].pose, rests_at, agent)
            if early_ns > 0 or off > POSE_M:
                report.add(new.begins_ns, new.pieces[0].pose, agent.name,
                           f"its leg begins {max(early_ns, 0) * 1e-9:.9f} s too early or {off:.6f} m from where it rests")
            track[-1:] = [] if unbegun else [old]
        track.append(new)
        check_pieces(report, agent, recording.limits[values[0]], new, leg.shared)
    return tracks


def rectangle(body, pose):
    """Returns the body at a pose: its middle, the direction of its length, half of its length and of its width."""
    x, y, heading = pose
    if body.is_square:  # parallel to the field, whatever the heading
        return x, y, 1.0, 0.0, body.length / 2, body.width / 2
    ux, uy, ahead = math.cos(heading), math.sin(heading), body.length / 2 - body.overhang
    return x + ahead * ux, y + ahead * uy, ux, uy, body.length / 2, body.width / 2


def gap(a, b):
    """Returns a lower bound of the distance of two rectangles, or minus the depth by which they overlap.

    This is the largest gap between their projections on the directions of their sides (separating axis theorem).
    """
    ax, ay, aux, auy, al, aw = a
    bx, by, bux, buy, bl, bw = b
    dx, dy = bx - ax, by - ay
    c, s = abs(aux * bux + auy * buy), abs(aux * buy - auy * bux)
    return max(abs(dx * aux + dy * auy) - al - bl * c - bw * s, abs(dy * aux - dx * auy) - aw - bl * s - bw * c,
               abs(dx * bux + dy * buy) - bl - al * c - aw * s, abs(dy * bux - dx * buy) - bw - al * s - aw * c)


def pace(body, curvature):
    """Returns the most metres by which a point of the body moves for each metre of its position."""
    farthest = max(body.length - body.overhang, body.overhang)
    return math.hypot(1 + abs(curvature) * body.width / 2, curvature * farthest)


def clearances(recording, report):
    """Returns a function from a rectangle to a lower bound of its distance to obstacles and edges, and the nearest's name.

    Squares that are as wide as the largest body list the bushes and blocked cells in them and around them.
    """
    cols, cell, half, squares = recording.cols, recording.cell, recording.cell / 2, {}
    width, height = cols * cell, recording.rows * cell
    side = max([2 * cell] + [math.hypot(agent.body.length, agent.body.width) for agent in recording.agents])
    for index in recording.bushes + recording.blocked:
        place = (index % cols + 0.5) * cell, (index // cols + 0.5) * cell
        for dx, dy in itertools.product((-1, 0, 1), repeat=2):
            squares.setdefault((int(place[0] / side) + dx, int(place[1] / side) + dy), []).append(place)

    def clearance(shape):
        x, y, ux, uy, long, wide = shape
        right, up, radius = long * abs(ux) + wide * abs(uy), long * abs(uy) + wide * abs(ux), math.hypot(long, wide)
        nearest, name = min(x - right, y - up, width - x - right, height - y - up, side - radius - half), "beyond the edge"
        obstacles = squares.get((int(x // side), int(y // side)), ())
        report.spend(1 + len(obstacles) // 4)
        for place in obstacles:
            if math.hypot(place[0] - x, place[1] - y) - radius - half * 1.415 < nearest:
                distance = gap(shape, (*place, 1.0, 0.0, half, half))
                if distance < nearest:
                    nearest, name = distance, f"in the obstacle at ({int(place[0] / cell)}, {int(place[1] / cell)})"
        return nearest, name

    return clearance


def check_bodies(recording, report, tracks):
    """Checks every body against obstacles and the edge along its paths.

    A body advances by its clearance and by a millimetre, so between two checked poses it is at most a millimetre deeper.
    """
    clearance_of = clearances(recording, report)
    for agent, track in zip(recording.agents, tracks):
        for path in track:
            for piece in path.pieces:
                way, clearance = 0.0, 0.0
                while clearance >= -DEPTH_M:
                    pose = along(piece.pose, piece.curvature, math.copysign(way, piece.length))
                    clearance, what = clearance_of(rectangle(agent.body, pose))
                    if way >= abs(piece.length):
                        break
                    way = min(way + (max(clearance, 0.0) + DEPTH_M) / pace(agent.body, piece.curvature), abs(piece.length))
                if clearance < -DEPTH_M:
                    report.add(path.begins_ns + round(piece.from_s * 1e9), pose, agent.name,
                               f"in the next {piece.lasts:.3f} s its body is {-clearance:.4f} m {what}")
                    break


def check_pairs(recording, report, tracks):
    """Checks every pair of trucks at all times: it advances by its gap over the most that both can move."""
    trucks = [(agent, track, [path.begins_ns for path in track]) for agent, track in zip(recording.agents, tracks)
              if agent.is_truck]
    fastest = [max([max(p.speed, p.last) * pace(agent.body, p.curvature) for path in track for p in path.pieces], default=0.0)
               for agent, track, _ in trucks]

    def moment(number, t_ns):
        """Returns a truck's rectangle, the most that it moves in a second, and until when."""
        agent, track, begins = trucks[number]
        at = max(bisect.bisect_right(begins, t_ns) - 1, 0)
        next_ns, rests = begins[at + 1] if at + 1 < len(track) else recording.end_ns, t_ns >= track[at].ends_ns
        until_ns = next_ns if rests else min(next_ns, track[at].ends_ns)
        return rectangle(agent.body, pose_at(track[at], t_ns)), 0.0 if rests else fastest[number], until_ns

    for first, second in ((first, second) for second in range(len(trucks)) for first in range(second)):
        t_ns = 0
        while t_ns < recording.end_ns:
            (a, a_mps, a_ns), (b, b_mps, b_ns) = moment(first, t_ns), moment(second, t_ns)
            distance = gap(a, b)
            report.spend(1)
            if distance < -DEPTH_M:
                report.add(t_ns, b, trucks[second][0].name, f"its body is {-distance:.4f} m in {trucks[first][0].name}")
                break
            step_s = (max(distance, 0.0) + DEPTH_M) / max(a_mps + b_mps, 1e-9)
            t_ns = max(t_ns + 1, min(a_ns, b_ns, t_ns + int(step_s * 1e9)))


def check_facts(recording, report, tracks):
    """Checks fires, stops and the end of the run; returns its results by the columns of runs.csv."""
    cols, cell, rules, end_ns = recording.cols, recording.cell, recording.rules, recording.end_ns
    fires = {bush: [] for bush in recording.bushes}  # of each bush: [ignited_ns, cause, source, ended_ns, state since]
    goals, stops, unreachable, points = {}, {}, {}, [0, 0]  # by agent; stops are [since_ns, cell, have they ended well]
    ends = [[path.ends_ns for path in track] for track in tracks]

    def fault(t_ns, bush, text, agent=None):
        name = "" if agent is None else recording.agents[agent].name
        report.add(t_ns, middle(bush), name, f"the bush at ({bush % cols}, {bush // cols}) {text}")

    def middle(bush):
        return (bush % cols + 0.5) * cell, (bush // cols + 0.5) * cell

    def mates(bush):
        return recording.piece_of.get(bush, (bush,))

    def rest(agent, t_ns):
        """Returns since when an agent rests at a time, -1 if it moves, and its pose then."""
        track, at = tracks[agent], max(bisect.bisect_right(ends[agent], t_ns + 1) - 1, 0)
        moves = track[at].ends_ns > t_ns + 1 or (at + 1 < len(track) and track[at + 1].begins_ns < t_ns)
        return -1 if moves else track[at].ends_ns, track[at].pieces[-1].end

    def check_arrival(t_ns, bush, agent, is_wumpus):
        if recording.agents[agent].is_truck == is_wumpus or goals.get(agent) not in mates(bush):
            fault(t_ns, bush, "is not the goal of this agent", agent)
        elif not -1 <= rest(agent, t_ns)[0] - t_ns <= 1:
            fault(t_ns, bush, "is not where this agent arrives at this time", agent)

    def check_reach(t_ns, bush, agent):
        distance = math.dist(middle(bush), rectangle(recording.agents[agent].body, rest(agent, t_ns)[1])[:2])
        if distance > rules.reach + POSE_M:
            fault(t_ns, bush, f"is {distance:.3f} m away, out of reach", agent)

    def close_stop(t_ns, agent):
        since_ns, bush, is_done = stops.pop(agent, (t_ns, None, True))
        if not is_done and rules.dwell_ns is not None and t_ns > since_ns + rules.dwell_ns:
            fault(since_ns + rules.dwell_ns, bush, "is not extinguished when the stop has lasted its dwell", agent)

    def ignite(t_ns, bush, cause, source=None, agent=None):
        if bush not in fires or (fires[bush] and not (fires[bush][-1][4] == EXTINGUISHED and rules.relight)):
            fault(t_ns, bush, "catches fire, but cannot burn at this time", agent)
        fires.setdefault(bush, []).append([t_ns, cause, source, None, BURNING])
        points[0] += rules.ignited

    def end(t_ns, bush, state, agent=None):
        if not fires.get(bush) or fires[bush][-1][4] != BURNING:
            fault(t_ns, bush, f"{'is extinguished' if state == EXTINGUISHED else 'burns out'}, but does not burn", agent)
        else:
            fires[bush][-1][3:] = t_ns, state
        points[state == EXTINGUISHED] += rules.extinguished if state == EXTINGUISHED else rules.burned_out

    for t_ns, kind, v, leg in recording.facts:
        if leg or kind == 12:
            close_stop(t_ns, v[0])
        if kind == 2:
            unreachable.setdefault(v[0], set()).update(v[1])
        elif kind == 3:
            check_arrival(t_ns, v[0], v[1], True)
            ignite(t_ns, v[0], LIT, agent=v[1])
        elif kind in (4, 5, 20):
            ignite(t_ns, v[0], SCHEDULE if kind == 5 else SPREAD, v[-1])
        elif kind == 19:
            for bush in v[1]:
                ignite(t_ns, bush, SPREAD, v[0])
        elif kind == 6:
            end(t_ns, v[0], BURNED_OUT)
        elif kind == 7:
            stop = stops.get(v[1], [t_ns, None, False])
            if rest(v[1], t_ns)[0] < 0 or rules.dwell_ns not in (None, t_ns - stop[0]):
                fault(t_ns, v[0], f"is extinguished after a stop of {(t_ns - stop[0]) * 1e-9:.9f} s", v[1])
            elif recording.one_at_a_stop and (stop[2] or v[0] != stop[1]) and v[0] not in recording.piece_of.get(stop[1], ()):
                fault(t_ns, v[0], "is extinguished by a stop for another one", v[1])
            if v[0] not in mates(stop[1]):
                check_reach(t_ns, v[0], v[1])
            stop[2] = True
            end(t_ns, v[0], EXTINGUISHED, v[1])
        elif kind in (8, 17):
            goals[v[0]] = v[1] if kind == 8 else None
        elif kind in (11, 25):
            check_arrival(t_ns, v[1], v[0], False)
            check_reach(t_ns, v[1], v[0])
            stops[v[0]] = [t_ns, v[1], False]
        if kind == 12 and fires.get(v[1]) and fires[v[1]][-1][4] == BURNING:
            fault(t_ns, v[1], "is given up, but still burns", v[0])
    for agent in list(stops):
        close_stop(end_ns, agent)
    if recording.fires:
        check_spread(recording, report, fires, fault)
    counts = [sum((of[-1][4] if of else INTACT) == state for of in fires.values()) for state in range(4)]
    causes = [sum(fire[1] == cause for of in fires.values() for fire in of) for cause in range(3)]
    open_bushes = [bush for bush, of in fires.items() if not of and any(
        bush not in unreachable.get(number, ()) for number, agent in enumerate(recording.agents) if not agent.is_truck)]
    _, kind, why, _ = recording.facts[-1]
    if kind != 14 or end_ns > rules.duration_ns or (why == [0] and end_ns != rules.duration_ns):
        report.add(end_ns, (0, 0), "", "the run does not end when it should")
    elif why == [1] and (counts[BURNING] or open_bushes):
        report.add(end_ns, (0, 0), "", "the run ends although something burns or can be lit")
    winner = "tie" if points[0] == points[1] else "unimog" if points[1] > points[0] else "wumpus"
    names = ("intact", "burning", "burned_out", "extinguished", "lit_by_wumpus", "caught_by_spread", "lit_by_schedule",
             "wumpus_score", "truck_score", "ended_s", "winner")
    return dict(zip(names, (*counts, *causes, *points, end_ns * 1e-9, winner)))


def check_spread(recording, report, fires, fault):
    """Checks every spread and burn-out under the model `radius`, and that none is missing; for fires see check_facts."""
    cols, rows, cell, rules = recording.cols, recording.rows, recording.cell, recording.fires
    end_ns, wide = recording.end_ns, int(min(rules.radius / recording.cell, MAX_SIDE)) + 1

    def spreads(fire, t_ns):
        """Returns whether a fire may spread at a time, and whether it has to: one that ends at this moment need not."""
        may = (rules.caught_spreads if fire[1] == SPREAD else rules.lit_spreads) and fire[0] + rules.delay_ns == t_ns
        return may and (fire[3] or end_ns) >= t_ns, may and (fire[3] or end_ns) > t_ns

    def far(a, b):
        return math.hypot(a % cols - b % cols, a // cols - b // cols) * cell / rules.radius if rules.radius else float(a != b)

    for bush, (ignited_ns, cause, source, ended_ns, state) in ((bush, fire) for bush in fires for fire in fires[bush]):
        until_ns, t_ns = ended_ns or end_ns, ignited_ns + rules.delay_ns
        out_ns = math.inf if rules.burn_out_ns is None else ignited_ns + rules.burn_out_ns
        if until_ns > out_ns or (state == BURNED_OUT and until_ns != out_ns):
            fault(until_ns, bush, f"burns for {(until_ns - ignited_ns) * 1e-9:.9f} s")
        if cause == SPREAD and not any(spreads(fire, ignited_ns)[0] for fire in fires.get(source, ())):
            fault(ignited_ns, bush, f"catches fire from ({source % cols}, {source // cols}), which does not spread now")
        elif cause == SPREAD and min(far(source, mate) for mate in recording.piece_of.get(bush, (bush,))) > 1 + 1e-9:
            fault(ignited_ns, bush, f"catches fire from ({source % cols}, {source // cols}), beyond the radius of spread")
        if not spreads((ignited_ns, cause, source, ended_ns), t_ns)[1]:
            continue
        col, row = bush % cols, bush // cols
        near = [other + line * cols for line in range(max(row - wide, 0), min(row + wide + 1, rows))
                for other in range(max(col - wide, 0), min(col + wide + 1, cols))]
        report.spend(len(near))
        for other in near:
            if other in fires and far(bush, other) <= 1 and not any(
                    fire[0] <= t_ns and (fire[4] != EXTINGUISHED or not rules.relight or fire[3] >= t_ns) for fire in fires[other]):
                fault(t_ns, other, f"is spared by the fire at ({col}, {row})")
    for piece in {id(piece): piece for piece in recording.piece_of.values()}.values():
        if any(fires[bush] and [fire[0::3] for fire in fires[bush]] != [fire[0::3] for fire in fires[piece[0]]] for bush in piece):
            fault(fires[piece[0]][0][0] if fires[piece[0]] else end_ns, piece[0], "does not burn and go out with all of its piece")


def check(recording, row):
    """Returns the violations of a recording, also against a row of runs.csv, and its results."""
    report, results = Report(), {}
    tracks = follow_legs(recording, report)
    check_bodies(recording, report, tracks)
    check_pairs(recording, report, tracks)
    if not recording.has_ground:
        results = check_facts(recording, report, tracks)
    for column, value in results.items():
        stated = row.get(column, str(value))
        if stated != value and not (re.fullmatch(r"[\d.e-]+", stated) and abs(float(stated) - value) <= 1e-9):
            report.add(recording.end_ns, (0, 0), "", f"runs.csv states {stated} for {column}; the recording gives {value}")
    return sorted(report.violations), results


def find_row(path):
    """Returns the row of the batch's runs.csv for one of its recordings, an empty one without."""
    numbers = re.fullmatch(r"(?:run-(\d+)-)?seed-(\d+).wildfire", os.path.basename(path))
    table = os.path.join(os.path.dirname(path), "..", "runs.csv")
    if numbers and os.path.exists(table):
        with open(table, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row.get("seed") == numbers[2] and numbers[1] in (None, row.get("run")):
                    return row
    return {}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split(":")[0] + ".", epilog="Exit codes: 0 good, 2 unreadable, 4 wrong.")
    parser.add_argument("paths", nargs="+", metavar="RECORDING|FOLDER")
    parser.add_argument("-q", "--quiet", action="store_true", help="print only violations, unreadable files and the sum")
    arguments = parser.parse_args()
    checked = wrong = unreadable = 0
    for given in arguments.paths:
        below = glob.glob(os.path.join(glob.escape(given), "**", "*.wildfire"), recursive=True)
        for path in sorted(below) if os.path.isdir(given) else [given]:
            try:
                recording = read_recording(path)
                violations, results = check(recording, find_row(path))
            except (Unreadable, OSError, ValueError, csv.Error) as error:
                unreadable += 1
                print(f"{path}: {error}", file=sys.stderr)
                continue
            checked, wrong = checked + 1, wrong + bool(violations)
            for t_ns, x, y, agent, text in violations[:MAX_PRINTED]:
                print(f"{path}: at {t_ns * 1e-9:.9f} s, ({x:.3f}, {y:.3f}) m: {agent + ': ' if agent else ''}{text}")
            if not arguments.quiet:
                listed = ", ".join(f"{name} {value}" for name, value in results.items())
                print(f"{path}: {recording.scenario}, seed {recording.seed}: {len(violations)} violations; {listed}")
                for what in recording.unchecked:
                    print(f"{path}: not checked: {what}")
    print(f"{checked} recordings checked, {wrong} with violations, {unreadable} unreadable")
    return 2 if unreadable else 4 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
