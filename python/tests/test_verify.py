"""The second referee finds nothing in runs, and each changed fact in recordings whose checksums are right.

``python tests/test_verify.py BATCH 200`` changes 200 facts of the recordings of a batch, drawn with seed 1, and lists them.
"""

from __future__ import annotations

import csv
import math
import pathlib
import random
import re
import struct
import sys
import tempfile
import zlib
from typing import Any

import pytest

import wildfire_contest as wf
from wildfire_contest import verify

IGNITIONS, ENDS = (3, 4, 5, 19), (6, 7)


def unsigned(value: int) -> bytes:
    encoded = bytearray()
    while value > 127:
        encoded.append(value & 127 | 128)
        value >>= 7
    return bytes(encoded + bytes([value]))


def signed(value: int) -> bytes:
    return unsigned(2 * value if value >= 0 else -2 * value - 1)


def block(content: bytes) -> bytes:
    return unsigned(len(content)) + content


class Editable:
    """A recording whose facts can be changed and written again, with right checksums.

    ``facts`` are lists [t_ns, kind, values, leg]; a leg is a list [start, pose, begins_ns, shared, pieces].
    """

    def __init__(self, path: pathlib.Path) -> None:
        spans = []
        read_facts = verify.read_facts

        def spy(data: verify.Bytes, *arguments: Any) -> list[verify.Fact]:
            begin = data.at
            facts = read_facts(data, *arguments)
            spans.append((begin, data.at))
            return facts

        verify.read_facts = spy
        try:
            self.recording = verify.read_recording(path)
        finally:
            verify.read_facts = read_facts
        payload = verify.read_payload(path)
        self.head, self.tail = payload[: spans[0][0]], payload[spans[0][1] :]
        self.facts = [[fact.t_ns, fact.kind, [list(value) if isinstance(value, list) else value for value in fact.values],
                       fact.leg and [*fact.leg[:4], [(kind, list(numbers)) for kind, numbers in fact.leg.pieces]]]
                      for fact in self.recording.facts]

    def encoded(self) -> bytes:
        bushes = {bush: index for index, bush in enumerate(self.recording.bushes)}
        delays, records, references, single, last_ns, count = bytearray(), bytearray(), bytearray(), [], 0, 0

        def number(value: float) -> None:
            single.append(value)
            references.extend(unsigned(0))

        def cell(index: int) -> int:
            return bushes.get(index, len(bushes) + index)

        for t_ns, kind, values, leg in self.facts:
            delays += unsigned(t_ns - last_ns)
            records += unsigned(kind)
            last_ns, count = t_ns, count + (len(values[1]) if kind == 19 else 1)
            for field, value in zip(verify.FIELDS[kind], values):
                if field == "n":
                    number(value)
                elif field == "s":
                    records += unsigned(len(value))
                    for before, after in zip([0, *map(cell, value)], map(cell, value)):
                        records += signed(after - before)
                elif field == "c":
                    records += unsigned(cell(value))
                else:
                    records += unsigned(value)
            if leg:
                start, pose, begins_ns, shared, pieces = leg
                records += unsigned(start)
                records += (unsigned(begins_ns - t_ns), unsigned(shared), signed(begins_ns - t_ns))[start]
                records += unsigned(len(pieces))
                for value in pose or ():
                    number(value)
                for piece, numbers in pieces:
                    records += unsigned(piece)
                    for value in numbers:
                        number(value)
        streams = unsigned(count) + block(bytes(delays)) + block(bytes(records)) + unsigned(0)
        streams += unsigned(len(single)) + struct.pack(f"<{len(single)}d", *single) + block(bytes(references))
        return packed(self.head + streams + self.tail)


def packed(payload: bytes) -> bytes:
    """The file of a payload."""
    deflater = zlib.compressobj(1, wbits=-15)
    stored = deflater.compress(payload) + deflater.flush()
    return b"WILDFIRE" + struct.pack("<HII", 9, len(stored), zlib.crc32(stored)) + stored


def with_time(edit: Editable, draw: random.Random) -> str:
    """Moves an ignition, an end, an arrival or a departure by 2 ns to 1 s, and not past its neighbours."""
    facts, places = edit.facts, []
    for at in range(1, len(facts) - 1):
        room_ns = min(facts[at][0] - facts[at - 1][0], facts[at + 1][0] - facts[at][0]) - 1
        if facts[at][1] in (*IGNITIONS, *ENDS, 11) and room_ns >= 2:
            places.append((at, room_ns))
    at, room_ns = draw.choice(places)
    shift_ns = draw.choice((-1, 1)) * round(math.exp(draw.uniform(math.log(2), math.log(min(room_ns, 10**9)))))
    fact = facts[at]
    fact[0] += shift_ns
    return f"time: fact {at} of kind {fact[1]} by {shift_ns} ns"


def with_state(edit: Editable, draw: random.Random) -> str:
    """Has a bush burn out that was extinguished or the reverse, or moves an ignition, an end or a stop to another bush."""
    places = [at for at, fact in enumerate(edit.facts) if fact[1] in (*IGNITIONS, *ENDS, 11)]
    at = draw.choice(places)
    fact = edit.facts[at]
    if fact[1] in ENDS and draw.random() < 0.5:
        trucks = [number for number, agent in enumerate(edit.recording.agents) if agent.is_truck]
        if fact[1] == 7 or trucks:
            fact[1:3] = [6, fact[2][:1]] if fact[1] == 7 else [7, [fact[2][0], trucks[0]]]
            return f"state: fact {at} is one of kind {fact[1]} now"
    if fact[1] == 19 and draw.random() < 0.5 and len(fact[2][1]) > 1:
        return f"state: bush {fact[2][1].pop(draw.randrange(len(fact[2][1])))} of fact {at} does not catch fire"
    cells = fact[2][1] if fact[1] == 19 else fact[2]
    place = draw.randrange(len(cells)) if fact[1] == 19 else 1 if fact[1] == 11 else 0
    other = draw.choice([bush for bush in edit.recording.bushes if bush != cells[place]])
    cells[place], before = other, cells[place]
    return f"state: fact {at} of kind {fact[1]} happens to {other}, not {before}"


def with_pose(edit: Editable, draw: random.Random) -> str:
    """Has a leg begin a centimetre to a metre, or 0.01 to 1 rad for a truck, from where its agent rests."""
    recording = edit.recording
    ends = [agent.start for agent in recording.agents]
    legs = []
    tracks = [verify.Path(0, 0, [verify.standing(start)], [0.0]) for start in ends]
    for at, fact in enumerate(recording.facts):
        if fact.leg:
            agent = fact.values[0]
            if fact.leg.start == 0:
                legs.append((at, tracks[agent].pieces[-1].end, 3 if recording.agents[agent].is_truck else 2))
            tracks[agent] = verify.build_path(fact.leg, tracks[agent])
    at, pose, axes = draw.choice(legs)
    axis, by = draw.randrange(axes), draw.choice((-1, 1)) * 10 ** draw.uniform(-2, 0)
    leg = edit.facts[at][3]
    leg[:2] = [2, tuple(value + by * (axis == number) for number, value in enumerate(pose))]
    return f"pose: the leg of fact {at} begins {by:.4f} from where it rests, along {('x', 'y', 'heading')[axis]}"


def with_path(edit: Editable, draw: random.Random) -> str:
    """Changes a drive: longer by a centimetre to a metre, faster than permitted, or tighter than the turning radius."""
    recording, places = edit.recording, []
    for at, (_, kind, values, leg) in enumerate(edit.facts[:-1]):
        # A leg that is aborted soon is written again, and the later one holds what was driven.
        stays = leg and not any(fact[3] and fact[3][0] == 1 and fact[2][0] == values[0] for fact in edit.facts[at + 1 : at + 60])
        if stays and kind == 8 and any(fact[1] in (3, 11) for fact in edit.facts[at + 1 :]):
            places += [(at, number) for number, (piece, numbers) in enumerate(leg[4]) if piece == 0 and abs(numbers[1]) > 0.1]
    at, number = draw.choice(places)
    fact = edit.facts[at]
    agent, limits = recording.agents[fact[2][0]], recording.limits[fact[2][0]]
    numbers = fact[3][4][number][1]
    how = draw.choice(("length", "speed", "curvature"))
    if how == "length":
        numbers[1] += math.copysign(10 ** draw.uniform(-2, 0), numbers[1])
    elif how == "speed":
        numbers[2] = (limits.forward if numbers[1] > 0 else limits.reverse) * draw.uniform(1.001, 1.5)
    else:
        numbers[0] = draw.choice((-1, 1)) * draw.uniform(1.001, 1.5) / (agent.radius if agent.is_truck else 1.0)
    return f"path: {how} of drive {number} in the leg of fact {at} of {agent.name} is {numbers}"


def with_score(row: dict[str, str], draw: random.Random) -> str:
    """Changes a result in a row of runs.csv."""
    column = draw.choice(("intact", "burned_out", "extinguished", "lit_by_wumpus", "wumpus_score", "truck_score", "winner"))
    before = row[column]
    if column == "winner":
        row[column] = draw.choice([word for word in ("wumpus", "unimog", "tie") if word != before])
    else:
        row[column] = str(float(before) + draw.choice((-2, -1, 1, 2)))
    return f"score: {column} is {row[column]}, not {before}"


def changed(path: pathlib.Path, kind: int, draw: random.Random, folder: pathlib.Path) -> tuple[str, list[tuple[Any, ...]]]:
    """Changes one fact of a recording; returns what was changed, and the violations that the referee finds."""
    table = path.parent.parent / "runs.csv"
    with table.open(newline="") as file:
        row = next(row for row in csv.DictReader(file) if path.name.endswith(f"seed-{row['seed']}.wildfire")
                   and (not path.name.startswith("run-") or path.name.startswith(f"run-{row['run']}-")))
    (folder / "recordings").mkdir(exist_ok=True)
    target = folder / "recordings" / path.name
    content = path.read_bytes()
    if kind == 4:
        what = with_score(row, draw)
    else:
        edit = Editable(path)
        what = (with_time, with_state, with_pose, with_path)[kind](edit, draw)
        content = edit.encoded()
    target.write_bytes(content)
    with (folder / "runs.csv").open("w", newline="") as file:
        # Only changes of scores are to be found by the table.
        writer = csv.DictWriter(file, row if kind == 4 else {"seed": "", "run": ""}, extrasaction="ignore")
        writer.writeheader()
        writer.writerow(row if kind == 4 else {"seed": "none", "run": "none"})
    return what, verify.check(target)[2]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A batch of ten recorded runs, two of them with three trucks."""
    out = tmp_path_factory.mktemp("verify")
    for scenario, seeds in (("smoke", "1..4"), ("contest", "7"), ("tetrominoes", "1"), ("coursework-2025", "1"),
                            ("original-2024", "1"), ("fleet", "1..2")):
        wf.batch(scenario, seeds=seeds, out=out / scenario, record="all")
    return out


def test_runs_have_no_violation(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert verify.main([str(folder)]) == 0
    assert capsys.readouterr().out.endswith("10 recordings checked, 0 with violations, 0 unreadable\n")


def test_an_unchanged_recording_is_encoded_without_a_change(folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    for path in folder.glob("*/recordings/*.wildfire"):
        edit = Editable(path)
        (tmp_path / "same.wildfire").write_bytes(edit.encoded())
        assert verify.read_recording(tmp_path / "same.wildfire") == edit.recording


def test_each_changed_fact_is_named(folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    paths, draw = sorted(folder.glob("*/recordings/*.wildfire")), random.Random(1)
    for number in range(30):
        path = draw.choice(paths)
        what, violations = changed(path, number % 5, draw, tmp_path)
        assert violations, f"{path}: {what}"


def test_no_file_crashes_it(folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    payload = bytearray(verify.read_payload(next(folder.glob("smoke/recordings/*.wildfire"))))
    draw, target = random.Random(2), tmp_path / "broken.wildfire"
    for _ in range(150):
        broken = bytearray(payload)
        for _ in range(draw.randint(1, 4)):
            broken[draw.randrange(len(broken))] = draw.randrange(256)
        target.write_bytes(packed(bytes(broken[: draw.choice((len(broken), draw.randrange(len(broken))))])))
        assert verify.main([str(target)]) in (0, 2, 4)
    assert verify.main([str(tmp_path / "missing.wildfire")]) == 2


def test_it_is_one_short_file_without_dependencies() -> None:
    source = pathlib.Path(verify.__file__).read_text()
    assert len(source.splitlines()) <= 600
    imported = set(re.findall(r"^(?:import|from) (\w+)", source, re.MULTILINE))
    assert imported <= set(sys.stdlib_module_names)


if __name__ == "__main__":
    drawn, recordings = random.Random(1), sorted(pathlib.Path(sys.argv[1]).glob("**/recordings/*.wildfire"))
    named = 0
    with tempfile.TemporaryDirectory() as temporary:
        for index in range(int(sys.argv[2])):
            recording = drawn.choice(recordings)
            text, found = changed(recording, index % 5, drawn, pathlib.Path(temporary))
            named += bool(found)
            print(f"{index + 1} {recording.parent.parent.name}/{recording.name}: {text}: {found[0][2:] if found else 'NOT NAMED'}")
    print(f"{named} of {sys.argv[2]} changed facts are named")
