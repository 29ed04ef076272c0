"""A second referee for recordings of the contest: `python verify.py RECORDING|FOLDER..`

This file needs nothing but Python 3.9 and shares no code with the program or its audit. It was written from two pages of
the guide, "Output files" (recordings) and "The arena" (audit). It checks again:

- bodies of trucks and Wumpuses against bushes, blocked cells and the edge along their whole paths; trucks against trucks
- turning radius, speeds and accelerations; that legs begin where and when their agent rests, or replace what was driven
- stops: arrival, standing still, dwell, reach; what a stop extinguishes, and when
- fires under the model `radius`: every ignition, spread and burn-out to the nanosecond, and that none is missing
- the end of the run; in the folder of a batch also the states, causes, scores and winner in `runs.csv`

A recording has neither the reach of Wumpuses nor the scenario's own ignitions, so these are taken as given. Ground that
burns, water, crews and steering rates are listed as not checked. Units are metres, seconds and radians unless a name ends
in `_ns`; headings are counter-clockwise from east. Exit codes: 0 no violation, 2 a file that cannot be read, 4 a violation.
"""

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

MAX_PAYLOAD_BYTES, MAX_SIDE, MAX_AGENTS = 65_554_432, 4096, 2000
# The format permits more; these limits keep a hostile file from taking all memory or more than a minute.
MAX_FACTS, MAX_PIECES, MAX_BUSHES, MAX_WORK = 500_000, 1_000_000, 1_000_000, 5_000_000
DEPTH_M = 0.001  # the depth to which bodies may overlap: the tolerance in docs/arena.md
POSE_M = 1e-5  # the difference by rounding between two descriptions of a pose
SPEED_MPS = 1e-3  # the difference by rounding between the speeds of consecutive pieces
RELATIVE = 1e-6  # the share by which rounding exceeds a limit

REPLACING = (10, 17, 22)  # kinds of facts whose leg replaces the previous one
DRIVE, TURN, STAND = range(3)
INTACT, BURNING, BURNED_OUT, EXTINGUISHED = range(4)
LIT, SPREAD, SCHEDULE = range(3)

Agent = namedtuple("Agent", "name is_truck start length width wheelbase overhang radius has_steering_rate")
Rules = namedtuple("Rules", "duration_ns reach dwell_ns relight ignited burned_out extinguished")
Fires = namedtuple("Fires", "delay_ns radius lit_spreads caught_spreads burn_out_ns")
Limits = namedtuple("Limits", "forward reverse acceleration braking lateral")
Fact = namedtuple("Fact", "t_ns kind values leg")  # values: the fields, with cells as indices of cells
Leg = namedtuple("Leg", "start pose begins_ns shared pieces")  # start: how it is given, from 0 to 2
Recording = namedtuple("Recording", "scenario seed cols rows cell bushes agents rules facts end_ns limits one_at_a_stop fires "
                       "piece_of blocked has_ground unchecked")
Piece = namedtuple("Piece", "kind from_s lasts pose end curvature length speed last acceleration")
Path = namedtuple("Path", "begins_ns ends_ns pieces starts_s")  # the first piece of a path stands for no time


def need(condition, message):
    if not condition:
        raise ValueError(message)


class Report(list):
    """The violations of a recording as (time in ns, place, agent or "", sentence), and the work done."""
    work = 0

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

    def numbers(self, count):
        values = struct.unpack(f"<{count}d", self.take(8 * count))
        need(all(map(math.isfinite, values)), "a number is not finite")
        return values

    def number(self):
        return self.numbers(1)[0]

    def optional(self, read):
        return read() if self.choice(2) else None

    def block(self):
        return self.take(self.unsigned())

    def rising_cells(self, cell_count):
        count = self.unsigned()
        need(count <= MAX_BUSHES, "it has more bushes than this program checks")
        cells = list(itertools.accumulate(self.unsigned() for _ in range(count)))
        need(cells[-1:] < [cell_count] and len(set(cells)) == count, "a list of cells repeats one or leaves the field")
        return cells


def read_payload(path):
    """Returns the inflated payload of a file; raises ValueError, zlib.error or OSError."""
    with open(path, "rb") as file:
        head = file.read(18)
        need(len(head) == 18 and head[:8] == b"WILDFIRE", "it is not a recording")
        version, size, checksum = struct.unpack("<HII", head[8:])
        need(version == 9, f"its format is version {version}; version 9 can be checked")
        stored = file.read(min(size, MAX_PAYLOAD_BYTES) + 1)
    need(len(stored) == size and zlib.crc32(stored) == checksum, "its length or its checksum is wrong")
    inflater = zlib.decompressobj(-15)
    payload = inflater.decompress(stored, MAX_PAYLOAD_BYTES)
    need(inflater.eof and not inflater.unused_data, "its payload is too large, or ends before the file")
    return payload


def read_agent(data):
    is_truck, number, start, kind = data.choice(2), data.unsigned(16), data.numbers(3), data.choice(3)
    sizes = data.numbers((1, 5, 6)[kind])  # the body is a square, a truck, or a truck with a steering rate
    sizes = sizes[:5] if kind else (sizes[0], sizes[0], 0.0, sizes[0] / 2, 1.0)
    agent = Agent(f"{'unimog' if is_truck else 'wumpus'}/{number}", is_truck == 1, start, *sizes, kind == 2)
    need(0 < agent.length <= 100 and 0 < agent.width <= 100 and 0 <= agent.overhang <= agent.length and agent.radius > 0
         and agent.is_truck == (kind > 0), "an agent has an impossible body")
    return agent


# Fields by kind of fact: a agent, c cell, u and w numbers of 32 and 64 bits, s cells, n number by reference, l leg, g graph.
FIELDS = "annn auuu as ca cc c c ca acuuul acuuuw acl ac ac au u acnn aca aal auuug cs cc auuunnl al auuuwnn aw acu".split()


def read_facts(data, bushes, agent_count, cell_count):
    """Reads the streams and returns the facts in order of time."""
    count, delays, records = data.unsigned(), Bytes(data.block()), Bytes(data.block())
    need(count <= MAX_FACTS, "it has more facts than this program checks")
    recurring, unread = data.numbers(data.unsigned()), deque(data.numbers(data.unsigned()))
    references = Bytes(data.block())
    facts, t_ns, total = [], 0, 0

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
        kinds = (records.choice(3) for _ in range(records.unsigned()))
        pose = tuple(number() for _ in range(3)) if start == 2 else None
        return Leg(start, pose, begins_ns, shared, [(kind, [number() for _ in range((4, 1, 1)[kind])]) for kind in kinds])

    readers = {"a": lambda: records.choice(agent_count), "c": lambda: named_cell(records.unsigned()), "u": records.unsigned,
               "w": lambda: records.unsigned(64), "s": cells, "n": number, "l": leg,
               "g": lambda: sum(records.signed() for _ in range(2 * (values[2] + values[3])))}
    while delays.at < len(delays.data):
        t_ns += delays.unsigned(64)
        kind, values = records.choice(len(FIELDS)), []
        for field in FIELDS[kind]:
            values.append(readers[field]())
        its_leg = values.pop() if FIELDS[kind].endswith("l") else None
        facts.append(Fact(t_ns, kind, values, its_leg))
        total += len(values[1]) if kind == 19 else 1
        need(total <= count, "it has more facts than it states")
    left = len(records.data) - records.at + len(references.data) - references.at + len(unread)
    need(left == 0 and total == count > 0, "its streams do not end together")
    return facts


def read_recording(path):
    """Reads a recording; raises ValueError if it breaks a guarantee of its format, zlib.error or OSError."""
    data = Bytes(read_payload(path))
    scenario, seed, _version = data.block().decode("utf-8", "replace"), data.unsigned(64), data.block()
    cols, rows, cell = data.unsigned(16), data.unsigned(16), data.number()
    need(1 <= cols <= MAX_SIDE and 1 <= rows <= MAX_SIDE and 0.001 <= cell <= 1e5, "its field has impossible dimensions")
    bushes, agent_count = data.rising_cells(cols * rows), data.unsigned()
    need(agent_count <= MAX_AGENTS, "it has more than 2000 agents")
    agents = [read_agent(data) for _ in range(agent_count)]
    duration_ns, reach, dwell_ns = data.unsigned(64), data.optional(data.number), data.unsigned(64)
    rules = Rules(duration_ns, math.inf if reach is None else reach, dwell_ns, data.choice(2), *data.numbers(3))
    facts = read_facts(data, bushes, agent_count, cols * rows)
    limits_count = data.unsigned()
    need(limits_count <= agent_count, "it has more limits than agents")
    limits = [data.optional(lambda: Limits(*data.numbers(2), *(data.optional(data.number) for _ in range(3))))
              for _ in range(limits_count)] + [None] * (agent_count - limits_count)
    extinguishes_all, fire_rules, fires, piece_of = data.optional(lambda: data.choice(2)), data.choice(3), None, {}
    if fire_rules:
        fires = Fires(data.unsigned(64), data.number(), data.choice(2), data.choice(2), data.optional(lambda: data.unsigned(64)))
        data.choice(2)
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
        rules = rules._replace(dwell_ns=math.inf)
    if fires is None or extinguishes_all is None or None in limits:
        unchecked.append("rules of fire and stops, or speed limits, that it does not state")
    unchecked += ["rates of steering"] * any(agent.has_steering_rate for agent in agents)
    return Recording(scenario, seed, cols, rows, cell, bushes, agents, rules, facts, facts[-1].t_ns, limits,
                     extinguishes_all == 0, fires, piece_of, blocked, has_ground, unchecked)


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
        need(leg.shared < len(old.pieces), "a leg shares more pieces than the last one has")
        pieces = old.pieces[: leg.shared + 1]
    for kind, numbers in leg.pieces:
        need(max(map(abs, numbers)) < 1e9, "a piece of a leg never ends")
        pose, from_s = pieces[-1].end, pieces[-1].from_s + pieces[-1].lasts
        if kind == DRIVE:
            curvature, length, speed, acceleration = numbers
            square = speed * speed + 2 * acceleration * abs(length)
            need(speed >= 0 and square > -1e-3, "a drive stops before its end")
            last = math.sqrt(max(0.0, square))
            lasts = 2 * abs(length) / (speed + last) if speed + last > 0 else math.inf if length else 0.0
            end = along(pose, curvature, length)
            pieces.append(Piece(DRIVE, from_s, lasts, pose, end, curvature, length, speed, last, acceleration))
        else:
            end, lasts = ((pose[0], pose[1], wrapped(numbers[0])), 0.0) if kind == TURN else (pose, numbers[0])
            pieces.append(standing(pose)._replace(kind=kind, from_s=from_s, lasts=lasts, end=end))
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


def check_pieces(report, agent, limits, path, shared):
    """Checks curvature and speeds of the pieces of a path that it does not share with the one before."""
    rise_limit, fall_limit = (SPEED_MPS if limit else None for limit in (limits.acceleration, limits.braking))
    pieces = path.pieces[shared:] + [standing(path.pieces[-1].end)]
    for before, piece in zip(pieces, pieces[1:]):
        fastest = max(piece.speed, piece.last)
        kept = min(piece.speed, before.last) if piece.length * before.length > 0 else 0.0  # through a cusp it keeps none
        for value, limit, what in (
            (piece.speed - kept, rise_limit, "the rise of its speed at once"),
            (before.last - kept, fall_limit, "the fall of its speed at once"),
            (fastest, limits.forward if piece.length > 0 else limits.reverse, "its speed"),
            (abs(piece.curvature), 1 / agent.radius if agent.is_truck else 0, "its curvature"),
            (piece.acceleration, limits.acceleration, "its acceleration"),
            (-piece.acceleration, limits.braking, "its braking"),
            (fastest**2 * abs(piece.curvature), limits.lateral, "its lateral acceleration"),
            (piece.kind == TURN and agent.is_truck, 0, "the number of turns on the spot"),
        ):
            if limit is not None and value > limit * (1 + RELATIVE):
                t_ns = path.begins_ns + round(piece.from_s * 1e9)
                report.append((t_ns, piece.pose, agent.name, f"{what} is {value:.6f}, more than {limit:.6f}"))


def follow_legs(recording, report):
    """Checks every leg against the one before; returns the paths that each agent drove, in order of time."""
    tracks, total = [[Path(0, 0, [standing(agent.start)], [0.0])] for agent in recording.agents], 0
    for t_ns, kind, values, leg in (fact for fact in recording.facts if fact.leg):
        agent, track = recording.agents[values[0]], tracks[values[0]]
        old, new = track[-1], build_path(leg, track[-1])
        total += len(new.pieces)
        need(total <= MAX_PIECES, "it has more pieces of legs than this program checks")
        if kind in REPLACING and new.begins_ns < t_ns:
            # Two arcs from one pose agree everywhere if they agree at the middle and the end of each piece.
            times = [t_ns] + [min(t_ns, new.begins_ns + round((piece.from_s + piece.lasts * part) * 1e9))
                              for piece in new.pieces[leg.shared :] for part in (0, 0.5, 1)]
            if new.begins_ns != old.begins_ns or any(apart(pose_at(old, t), pose_at(new, t), agent) > POSE_M for t in times):
                report.append((t_ns, pose_at(old, t_ns), agent.name, "its aborted leg was not driven as planned"))
            track.pop()
        else:
            unbegun = kind in REPLACING and old.begins_ns >= t_ns
            rests_ns, rests_at = (0, old.pieces[0].pose) if unbegun else (old.ends_ns, old.pieces[-1].end)
            early_ns, off = max(rests_ns - 1, t_ns) - new.begins_ns, apart(new.pieces[0].pose, rests_at, agent)
            if early_ns > 0 or off > POSE_M:
                text = f"{off:.6f} m or rad from where it rests" if off > POSE_M else f"{early_ns * 1e-9:.9f} s too early"
                report.append((new.begins_ns, new.pieces[0].pose, agent.name, f"its leg begins {text}"))
            track[-1:] = [] if unbegun else [old]
        track.append(new)
        check_pieces(report, agent, recording.limits[values[0]] or Limits(*[None] * 5), new, leg.shared)
    return tracks


def rectangle(agent, pose):
    """Returns the body at a pose: its middle, the direction of its length, half of its length and of its width."""
    heading = pose[2] if agent.is_truck else 0.0  # the square of a Wumpus stays parallel to the field
    ux, uy, ahead = math.cos(heading), math.sin(heading), agent.length / 2 - agent.overhang
    return pose[0] + ahead * ux, pose[1] + ahead * uy, ux, uy, agent.length / 2, agent.width / 2


def gap(a, b):
    """Returns a lower bound of the distance of two rectangles, or minus the depth by which they overlap."""
    # The largest gap between their projections on the directions of their sides (separating axis theorem).
    ax, ay, aux, auy, al, aw = a
    bx, by, bux, buy, bl, bw = b
    dx, dy = bx - ax, by - ay
    c, s = abs(aux * bux + auy * buy), abs(aux * buy - auy * bux)
    return max(abs(dx * aux + dy * auy) - al - bl * c - bw * s, abs(dy * aux - dx * auy) - aw - bl * s - bw * c,
               abs(dx * bux + dy * buy) - bl - al * c - aw * s, abs(dy * bux - dx * buy) - bw - al * s - aw * c)


def pace(agent, curvature):
    """Returns the most metres by which a point of the body moves for each metre of its position."""
    farthest = max(agent.length - agent.overhang, agent.overhang)
    return math.hypot(1 + abs(curvature) * agent.width / 2, curvature * farthest)


def check_bodies(recording, report, tracks):
    """Checks every body against obstacles and the edge along its paths."""
    cols, cell, half, squares = recording.cols, recording.cell, recording.cell / 2, {}
    # Squares that are as wide as the largest body list the bushes and blocked cells in them and around them.
    side = max([2 * cell] + [math.hypot(agent.length, agent.width) for agent in recording.agents])
    for index in recording.bushes + recording.blocked:
        place = (index % cols + 0.5) * cell, (index // cols + 0.5) * cell
        for dx, dy in itertools.product((-1, 0, 1), repeat=2):
            squares.setdefault((int(place[0] / side) + dx, int(place[1] / side) + dy), []).append(place)
    def clearance_of(shape):
        """Returns a lower bound of the distance to the nearest obstacle or edge, negative inside, and its name."""
        x, y, ux, uy, long, wide = shape
        right, up, radius = long * abs(ux) + wide * abs(uy), long * abs(uy) + wide * abs(ux), math.hypot(long, wide)
        nearest = min(x - right, y - up, cols * cell - x - right, recording.rows * cell - y - up, side - radius - half)
        obstacles, name = squares.get((x // side, y // side), ()), "beyond the edge"
        report.spend(1 + len(obstacles) // 4)
        for place in obstacles:
            if math.hypot(place[0] - x, place[1] - y) - radius - half * 1.415 < nearest:
                distance = gap(shape, (*place, 1.0, 0.0, half, half))
                if distance < nearest:
                    nearest, name = distance, f"in the obstacle at ({int(place[0] / cell)}, {int(place[1] / cell)})"
        return nearest, name

    for agent, path, piece in ((a, path, piece) for a, track in zip(recording.agents, tracks) for path in track
                               for piece in path.pieces):
        way, clearance = 0.0, 0.0
        while clearance >= -DEPTH_M:
            pose = along(piece.pose, piece.curvature, math.copysign(way, piece.length))
            clearance, what = clearance_of(rectangle(agent, pose))
            if way >= abs(piece.length):
                break
            # One millimetre beyond the clearance: between two checked poses a body is at most that much deeper.
            way = min(way + (max(clearance, 0.0) + DEPTH_M) / pace(agent, piece.curvature), abs(piece.length))
        if clearance < -DEPTH_M:
            text = f"in the next {piece.lasts:.3f} s its body is {-clearance:.4f} m {what}"
            report.append((path.begins_ns + round(piece.from_s * 1e9), pose, agent.name, text))


def check_pairs(recording, report, tracks):
    """Checks every pair of trucks at all times: it advances by its gap over the most that both can move."""
    trucks = [(agent, track, [p.begins_ns for p in track]) for agent, track in zip(recording.agents, tracks) if agent.is_truck]
    fastest = [max(max(piece.speed, piece.last) * pace(agent, piece.curvature) for path in track for piece in path.pieces)
               for agent, track, _ in trucks]
    def moment(number, t_ns):
        """Returns a truck's rectangle, the most that it moves in a second, and until when."""
        agent, track, begins = trucks[number]
        at = max(bisect.bisect_right(begins, t_ns) - 1, 0)
        next_ns, rests = begins[at + 1] if at + 1 < len(track) else recording.end_ns, t_ns >= track[at].ends_ns
        until_ns = next_ns if rests else min(next_ns, track[at].ends_ns)
        return rectangle(agent, pose_at(track[at], t_ns)), 0.0 if rests else fastest[number], until_ns

    for first, second in ((first, second) for second in range(len(trucks)) for first in range(second)):
        t_ns = 0
        while t_ns < recording.end_ns:
            (a, a_mps, a_ns), (b, b_mps, b_ns) = moment(first, t_ns), moment(second, t_ns)
            distance = gap(a, b)
            report.spend(1)
            if distance < -DEPTH_M:
                report.append((t_ns, b, trucks[second][0].name, f"its body is {-distance:.4f} m in {trucks[first][0].name}"))
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
        name, bush_name = "" if agent is None else recording.agents[agent].name, f"({bush % cols}, {bush // cols})"
        report.append((t_ns, middle(bush), name, f"the bush at {bush_name} {text}"))
    def middle(bush):
        return (bush % cols + 0.5) * cell, (bush // cols + 0.5) * cell
    def mates(bush):
        return recording.piece_of.get(bush, (bush,))
    def rests_at(agent, t_ns):
        """Returns since when an agent rests at a time, -1 if it moves, and its pose then."""
        track, at = tracks[agent], max(bisect.bisect_right(ends[agent], t_ns + 1) - 1, 0)
        moves = track[at].ends_ns > t_ns + 1 or (at + 1 < len(track) and track[at + 1].begins_ns < t_ns)
        return -1 if moves else track[at].ends_ns, track[at].pieces[-1].end
    def check_arrival(t_ns, bush, agent, is_wumpus):
        if recording.agents[agent].is_truck == is_wumpus or goals.get(agent) not in mates(bush):
            fault(t_ns, bush, "is not the goal of this agent", agent)
        elif abs(rests_at(agent, t_ns)[0] - t_ns) > 1:
            fault(t_ns, bush, "is not where this agent arrives at this time", agent)
        elif not is_wumpus:
            check_reach(t_ns, bush, agent)
    def check_reach(t_ns, bush, agent):
        distance = math.dist(middle(bush), rectangle(recording.agents[agent], rests_at(agent, t_ns)[1])[:2])
        if distance > rules.reach + POSE_M:
            fault(t_ns, bush, f"is {distance:.3f} m away, out of reach", agent)
    def close_stop(t_ns, agent):
        since_ns, bush, is_done = stops.pop(agent, (t_ns, None, True))
        if not is_done and t_ns > since_ns + rules.dwell_ns:
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
        elif kind in (4, 5, 19, 20):
            for bush in v[1] if kind == 19 else v[:1]:
                ignite(t_ns, bush, SCHEDULE if kind == 5 else SPREAD, v[0] if kind == 19 else v[-1])
        elif kind == 6:
            end(t_ns, v[0], BURNED_OUT)
        elif kind == 7:
            stop = stops.get(v[1], [t_ns, None, False])
            if rests_at(v[1], t_ns)[0] < 0 or rules.dwell_ns not in (math.inf, t_ns - stop[0]):
                fault(t_ns, v[0], f"is extinguished after a stop of {(t_ns - stop[0]) * 1e-9:.9f} s", v[1])
            elif recording.one_at_a_stop and (stop[2] or v[0] != stop[1]) and v[0] not in recording.piece_of.get(stop[1], ()):
                fault(t_ns, v[0], "is extinguished by a stop for another one", v[1])
            elif v[0] not in mates(stop[1]):
                check_reach(t_ns, v[0], v[1])
            stop[2] = True
            end(t_ns, v[0], EXTINGUISHED, v[1])
        elif kind in (8, 17):
            goals[v[0]] = v[1] if kind == 8 else None
        elif kind in (11, 25):
            check_arrival(t_ns, v[1], v[0], False)
            stops[v[0]] = [t_ns, v[1], False]
        if kind == 12 and fires.get(v[1]) and fires[v[1]][-1][4] == BURNING:
            fault(t_ns, v[1], "is given up, but still burns", v[0])
    for agent in list(stops):
        close_stop(end_ns, agent)
    if recording.fires:
        check_spread(recording, report, fires, fault)
    counts = [sum((of[-1][4] if of else INTACT) == state for of in fires.values()) for state in range(4)]
    causes = [sum(fire[1] == cause for of in fires.values() for fire in of) for cause in range(3)]
    wumpuses = [number for number, agent in enumerate(recording.agents) if not agent.is_truck]
    left = counts[BURNING] or any(not of and any(bush not in unreachable.get(number, ()) for number in wumpuses)
                                  for bush, of in fires.items())
    _, kind, why, _ = recording.facts[-1]
    if kind != 14 or end_ns > rules.duration_ns or (why == [0] and end_ns != rules.duration_ns) or (why == [1] and left):
        report.append((end_ns, (0, 0), "", "the run ends before its duration although something is left, or it does not end"))
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
            if other in fires and far(bush, other) <= 1 and not any(fire[0] <= t_ns and (
                    fire[4] != EXTINGUISHED or not recording.rules.relight or fire[3] >= t_ns) for fire in fires[other]):
                fault(t_ns, other, f"is spared by the fire at ({col}, {row})")
    times = {bush: [(fire[0], fire[3]) for fire in of] for bush, of in fires.items()}
    for bush, piece in recording.piece_of.items():
        if times[bush] != times[piece[0]]:
            fault((times[bush] or times[piece[0]])[0][0], bush, "does not catch fire and go out with the rest of its piece")


def check(path):
    """Returns the recording in a file, its results, and its violations, also against the runs.csv of its batch."""
    recording, report, results = read_recording(path), Report(), {}
    tracks = follow_legs(recording, report)
    check_bodies(recording, report, tracks)
    check_pairs(recording, report, tracks)
    if not recording.has_ground:
        results = check_facts(recording, report, tracks)
    numbers = re.fullmatch(r"(?:run-(\d+)-)?seed-(\d+).wildfire", os.path.basename(path))
    table = os.path.join(os.path.dirname(path), "..", "runs.csv")
    if numbers and os.path.exists(table):
        with open(table, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["seed"] == numbers[2] and numbers[1] in (None, row["run"])]
        for column, value in results.items() if rows else ():
            stated = rows[0][column]
            if stated != value and not (re.fullmatch(r"-?\d+(\.\d+)?", stated) and abs(float(stated) - value) <= 1e-9):
                report.append((recording.end_ns, (0, 0), "", f"runs.csv states {column} {stated}, the recording {value}"))
    return recording, results, sorted(report)


def main(arguments):
    """Checks the recordings that the arguments name, also all in folders; returns the exit code."""
    checked = wrong = unreadable = 0
    for given in arguments:
        below = glob.glob(os.path.join(glob.escape(given), "**", "*.wildfire"), recursive=True)
        for path in sorted(below) if os.path.isdir(given) else [given]:
            try:
                recording, results, violations = check(path)
            except (OSError, ValueError, KeyError, csv.Error, zlib.error) as error:
                unreadable += 1
                print(f"{path}: {error}", file=sys.stderr)
                continue
            checked, wrong = checked + 1, wrong + bool(violations)
            for t_ns, (x, y, *_), agent, text in violations[:20]:
                print(f"{path}: at {t_ns * 1e-9:.9f} s, ({x:.3f}, {y:.3f}) m: {agent + ': ' if agent else ''}{text}")
            print(f"{path}: {recording.scenario}, seed {recording.seed}: {len(violations)} violations;",
                  ", ".join(f"{name} {value}" for name, value in results.items()),
                  *(f"\n{path}: not checked: {what}" for what in recording.unchecked))
    print(f"{checked} recordings checked, {wrong} with violations, {unreadable} unreadable")
    return 2 if unreadable else 4 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) if sys.argv[1:] else __doc__)
