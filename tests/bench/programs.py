# SPDX-License-Identifier: MIT
"""Runs of the programs that are compared, and what they say of themselves."""

import dataclasses
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
ONE_SAMPLE = "one sample"
# Instruction sets, and what the C library must not see of the machine for them to be the best that there is.
LEVELS = {"x86-64": "-AVX2,-FMA", "x86-64-v3": "-AVX512F"}


@dataclasses.dataclass
class Run:
    """Seconds; `whole` and `wall` by the clock, the others of processor time. Memory in bytes."""
    parse: float
    prepare: float
    trace: float
    wall: float  # of the tracing
    whole: float
    memory: int
    picture: pathlib.Path


class Failure(Exception):
    pass


def pinned(cores):
    return ["taskset", "-c", cores] if shutil.which("taskset") else []


def execute(command, folder, variables={}):
    """The seconds by the clock, the peak memory and the messages of a process that is to succeed."""
    with tempfile.TemporaryFile() as messages:
        begin = time.perf_counter()
        process = subprocess.Popen([str(word) for word in command], cwd=folder, stdout=messages, stderr=messages,
                                   env=os.environ | variables)
        _, status, usage = os.wait4(process.pid, 0)
        whole = time.perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        messages.seek(0)
        text = messages.read().decode(errors="replace")
    if process.returncode != 0:
        raise Failure(f"{command}\nends with {process.returncode}:\n{text[-2000:]}")
    return whole, usage.ru_maxrss * 1024, text


def found(pattern, text):
    match = re.search(pattern, text, re.S)
    if not match:
        raise Failure(f"no '{pattern}' in:\n{text[-2000:]}")
    return float(match.group(1))


class Lapidary:
    """A quality is ONE_SAMPLE, or options that replace --samples 1.

    While a picture is traced, a thread loads the library that will write it: a sixth of a second of work, which the clock would count as
    tracing where all cores are busy. Where times by the clock are compared, the library is `loaded_before`.
    """

    def __init__(self, name="ours", program=ROOT / "build" / "bin" / "lapidary", options=(), threads=1, cores="0", level=None, loaded_before=False):
        self.name, self.program, self.options, self.level = name, pathlib.Path(program).resolve(), list(options), level
        self.threads, self.cores = threads, cores
        if not os.access(self.program, os.X_OK):
            raise Failure(f"no program {self.program}; build it with: sh .ci/build")
        self.variables = {"GLIBC_TUNABLES": f"glibc.cpu.hwcaps={LEVELS[level]}"} if level else {}
        if loaded_before:
            self.variables["LD_PRELOAD"] = self.image_library()

    def image_library(self):
        module = self.program.parent.parent / "lib" / "lapidary" / "modules" / "image.so"
        needed = subprocess.run(["ldd", module], capture_output=True, text=True).stdout
        match = re.search(r"=> (\S*/libOpenImageIO\.so\S*)", needed)
        if not match:
            raise Failure(f"no libOpenImageIO among what {module} needs:\n{needed}")
        return match.group(1)

    def run(self, workload, size, folder, quality=ONE_SAMPLE):
        picture = folder / f"{workload.name}-{self.name}.png"
        chosen = ["--samples", "1"] if quality == ONE_SAMPLE else quality
        whole, memory, text = execute(
            [*pinned(self.cores), self.program, "-v", "-w", "-j", self.threads, "--resolution", "{}x{}".format(*size),
             "--set", "output.encoding=linear", "--set", "output.png.bits=16", *chosen, *self.options, "-o", picture, workload.ours], folder,
            self.variables)
        if self.level and f"\ninstruction set {self.level}\n" not in text:
            raise Failure(f"not built for {self.level}, or this machine lacks it:\n{text[-2000:]}")
        of_processor = lambda stage: 1e-3 * found(rf"\n{stage} +[\d.]+ ms, ([\d.]+) ms of processor time", text)
        return Run(parse=of_processor("load") + of_processor("build"), prepare=of_processor("prepare"), whole=whole, memory=memory,
                   wall=1e-3 * found(r"\nrender +([\d.]+) ms", text),
                   trace=1e-3 * found(r"traced in ([\d.]+) ms of processor time", text), picture=picture)


class PovRay:
    """A quality is ONE_SAMPLE, or options that replace -A."""
    name = "POV-Ray"

    def __init__(self, threads=1, cores="0"):
        self.threads, self.cores = threads, cores
        if shutil.which("povray") is None:
            raise Failure("povray is not installed")

    def run(self, workload, size, folder, quality=ONE_SAMPLE, portable=False):
        """The picture is a PNG, or a PPM where it is to be `portable`."""
        picture = folder / f"{workload.name}-povray.{'ppm' if portable else 'png'}"
        chosen = ["-A"] if quality == ONE_SAMPLE else quality
        width, height = size
        whole, memory, text = execute(
            [*pinned(self.cores), "povray", f"+I{workload.povray}", f"+L{HERE / 'povray'}", f"+O{picture}", f"+W{width}", f"+H{height}",
             f"+WT{self.threads}", *chosen, "-D", "-V", "+FP16" if portable else "+FN16", "File_Gamma=1.0", f"Declare=IW={width}", f"Declare=IH={height}"], folder)
        of_processor = lambda stage: found(rf"{stage} Time:[^\n]*\n[^\n]*with ([\d.]+) CPU-seconds", text)
        return Run(parse=of_processor("Parse"), prepare=of_processor("Bounding"), trace=of_processor("Trace"), whole=whole, memory=memory,
                   wall=found(r"Trace Time:[^\n]*\(([\d.]+) seconds\)", text), picture=picture)


def difference(a, b, program):
    """RMSE of two pictures, channel value by channel value."""
    done = subprocess.run([program, "compare", "--tolerance", "1", a, b], capture_output=True, text=True)
    return found(r"RMSE +([\d.e+-]+)", done.stdout + done.stderr)
