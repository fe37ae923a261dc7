# SPDX-License-Identifier: MIT
"""Run time against error: each program at a ladder of qualities, against a converged reference of its own."""

import array
import math
import statistics
import struct
import sys
import zlib

from charts import Line, line_chart
from programs import ONE_SAMPLE, difference

# What is rendered where nothing else is asked for, and how large. Mirrors in glass take POV-Ray many minutes for larger references.
USUAL = {"dice": (320, 240), "spheres-1000": (320, 240), "cheese-100": (320, 240), "trees": (320, 240), "matdemo": (320, 240), "extreme": (96, 72)}

OUR_QUALITIES = [ONE_SAMPLE] + [["--error", str(error)] for error in (0.8, 0.4, 0.2, 0.1, 0.05, 0.025, 0.012, 0.006, 0.003, 0.0015)]
OUR_REFERENCE = ["--samples", "1024", "--sequence", "1"]  # independent of the samples that are judged

# Settings of which none is both slower and worse than another one on all workloads, and between which there are no wide gaps.
POVRAY_QUALITIES = [ONE_SAMPLE] + [setting.split() for setting in (
    "+AM2 +A0.0 +R1", "+AM2 +A0.3 +R2", "+AM1 +A0.3 +R3", "+AM2 +A0.3 +R3", "+AM2 +A0.1 +R3 Antialias_Gamma=1.0", "+AM2 +A0.1 +R4",
    "+AM1 +A0.03 +R5", "+AM2 +A0.03 +R4", "+AM1 +A0.03 +R7", "+AM1 +A0.0 +R7", "+AM1 +A0.0 +R9 -J")]
# The settings that a summary tells of, from coarse to fine.
TOLD = [ONE_SAMPLE, "+AM2 +A0.3 +R2", "+AM2 +A0.1 +R4", "+AM1 +A0.0 +R9 -J"]
# Nine by nine samples a pixel, at four shifts that interleave them to eighteen by eighteen.
POVRAY_REFERENCE = ["+AM1", "+A0.0", "+R9", "-J"]
SHIFTS = [(x / 36, y / 36) for x in (-1, 1) for y in (-1, 1)]


def read_ppm(path):
    """Width, height, and the values of 16 bits."""
    data = path.read_bytes()
    words, place = [], 0
    while len(words) < 4:
        end = place
        while data[end] not in b" \t\r\n":
            end = data.index(b"\n", end) if data[end] == ord("#") else end + 1
        word = data[place:end]
        if word and not word.startswith(b"#"):
            words.append(word)
        place = end + 1
    if words[0] != b"P6" or words[3] != b"65535":
        raise ValueError(f"{path} is no PPM of 16 bits")
    values = array.array("H", data[place:])
    if sys.byteorder == "little":
        values.byteswap()
    return int(words[1]), int(words[2]), values


def write_png(path, width, height, values):
    """RGB of 16 bits, not filtered."""
    values = array.array("H", values)
    if sys.byteorder == "little":
        values.byteswap()
    raw, stride = values.tobytes(), 6 * width
    rows = b"".join(b"\0" + raw[y * stride:(y + 1) * stride] for y in range(height))
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 2, 0, 0, 0))
                     + chunk(b"gAMA", struct.pack(">I", 100000)) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


def our_reference(program, workload, size, folder):
    path = folder / f"{workload.name}-reference.png"
    program.run(workload, size, folder, OUR_REFERENCE).picture.rename(path)
    return path


def povray_reference(program, workload, size, folder):
    pictures = []
    for x, y in SHIFTS:
        run = program.run(workload, size, folder, [*POVRAY_REFERENCE, f"Declare=SX={x}", f"Declare=SY={y}"], portable=True)
        width, height, values = read_ppm(run.picture)
        pictures.append(values)
    path = folder / f"{workload.name}-povray-reference.png"
    write_png(path, width, height, [(a + b + c + d + 2) // 4 for a, b, c, d in zip(*pictures)])
    return path


def written(quality):
    return quality if quality == ONE_SAMPLE else " ".join(quality)


class Ladder:
    """One program on one workload."""

    def __init__(self, program, qualities, reference):
        self.program, self.qualities, self.reference = program, qualities, reference
        self.times = [[] for _ in qualities]  # of each quality, round by round
        self.errors = []                      # of each quality: the same in all rounds

    def climb(self, workload, size, folder, compare, longest, enough=0):
        """A round; steps that take too long or have error enough end it, and no finer one is tried again."""
        for i, quality in enumerate(self.qualities):
            run = self.program.run(workload, size, folder, quality)
            self.times[i].append(run.trace)
            if len(self.errors) == i:
                self.errors.append(compare(run.picture, self.reference))
            if run.trace > longest or self.errors[i] < enough:
                self.qualities = self.qualities[:i + 1]
                break

    def time_at(self, error, round_):
        """Interpolated on logarithms between the steps around that error; nothing if it is finer than the finest. What is better than
        the coarsest step needs is given the coarsest step's time."""
        steps = undominated([(times[round_], e) for times, e in zip(self.times, self.errors) if len(times) > round_])
        if error >= steps[0][1]:
            return steps[0][0]
        for (t0, e0), (t1, e1) in zip(steps, steps[1:]):
            if error >= e1:
                part = math.log(error / e0) / math.log(e1 / e0)
                return math.exp(math.log(t0) + part * math.log(t1 / t0))
        return None

    def result(self):
        return [{"quality": written(quality), "trace": statistics.median(times), "error": error}
                for quality, times, error in zip(self.qualities, self.times, self.errors)]


def undominated(steps):
    """Of (time, error), from coarse to fine: what nothing else beats in both."""
    kept = []
    for time, error in sorted(steps):
        if not kept or error < kept[-1][1]:
            kept.append((time, error))
    return kept


def equal_error(ours, theirs, rounds):
    """Of each setting of theirs that no other one beats: the ratio of their time to ours at that error."""
    medians = [(statistics.median(times), error) for times, error in zip(theirs.times, theirs.errors)]
    rows = []
    for time, error in undominated(medians):
        i = medians.index((time, error))
        times = [(ours.time_at(error, r), theirs.times[i][r]) for r in range(min(rounds, len(theirs.times[i])))]
        pairs = [(a, b) for a, b in times if a]
        rows.append({"quality": written(theirs.qualities[i]), "error": error, "theirs": time,
                     "ours": statistics.median(a for a, _ in pairs) if pairs else None,
                     "ratio": statistics.median(b / a for a, b in pairs) if pairs else None})
    return rows


def climb(pair, workload, options, folder):
    ours, theirs = pair
    size = options.size or USUAL.get(workload.name, (320, 240))
    compare = lambda a, b: difference(a, b, ours.program)
    ladders = (Ladder(ours, OUR_QUALITIES, our_reference(ours, workload, size, folder)),
               Ladder(theirs, POVRAY_QUALITIES, povray_reference(theirs, workload, size, folder)))
    for _ in range(options.rounds):
        ladders[1].climb(workload, size, folder, compare, options.longest)
        ladders[0].climb(workload, size, folder, compare, options.longest, enough=min(ladders[1].errors))
    return {"workload": workload.name, "size": size, "ours": ladders[0].result(), "theirs": ladders[1].result(),
            "references_differ": compare(ladders[0].reference, ladders[1].reference), "equal_error": equal_error(*ladders, options.rounds)}


def table(result):
    width, height = result["size"]
    lines = [f"{result['workload']}, {width}x{height} (the two references differ by {result['references_differ']:.5f})",
             f"    {'POV-Ray at':<34}{'RMSE':>10}{'POV-Ray, s':>12}{'ours, s':>10}{'ratio':>9}"]
    for row in result["equal_error"]:
        ours = "-" if row["ours"] is None else f"{row['ours']:.3f}"
        ratio = "-" if row["ratio"] is None else f"{row['ratio']:.2f}"
        lines.append(f"    {row['quality']:<34}{row['error']:>10.5f}{row['theirs']:>12.3f}{ours:>10}{ratio:>9}")
    lines.append(f"    {'ours at':<34}{'RMSE':>10}{'':>12}{'ours, s':>10}")
    lines += [f"    {row['quality']:<34}{row['error']:>10.5f}{'':>12}{row['trace']:>10.3f}" for row in result["ours"]]
    return "\n".join(lines)


def summary(results):
    """Ratios at equal error of all workloads, as a table in Markdown."""
    lines = ["| POV-Ray / ours | " + " | ".join("`-A`" if quality == ONE_SAMPLE else f"`{quality}`" for quality in TOLD) + " |", "| --- |" + " --- |" * len(TOLD)]
    for result in results:
        rows = {row["quality"]: row for row in result["equal_error"] if row["ratio"] is not None}
        cells = [f"{rows[q]['ratio']:.2g} ({rows[q]['error']:.2g})" if q in rows else "-" for q in TOLD]
        lines.append(f"| {result['workload']} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def chart(title, results):
    """Two lines of each workload: ours whole, POV-Ray's dashed."""
    lines = []
    for i, result in enumerate(results):
        for whose, dashed in (("ours", False), ("theirs", True)):
            steps = undominated([(row["trace"], row["error"]) for row in result[whose] if row["error"] > 0])
            lines.append(Line(result["workload"] + (", POV-Ray" if dashed else ""), [(error, time) for time, error in steps], i, dashed))
    return line_chart(title, "RMSE in linear light", "seconds of processor time", lines)
