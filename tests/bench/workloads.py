#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The workloads of the bench, each as one scene in two languages: same solids, light, colours and camera.

    tests/bench/workloads.py spheres-1000 dice.scene     writes ours
    tests/bench/workloads.py spheres-1000 dice.pov       writes POV-Ray's

    spheres-N   N times (ball − smaller ball that overlaps it), at random in a cube, of which the balls would fill 11 %
    dice        52 times (cube ∩ ball − 21 pips), turned at random: 1 196 primitives
    dice-cut    (all of these dice in one union) − a big ball: one solid
    cheese-N    one cube − N balls, which together have 11 % of its volume
    table       two dice and five marbles on a mirror
    trees       twelve lights
    matdemo     textures in textures
    extreme     mirrors and glass

The first four are made here, from a description that knows neither language, with every number written out alike; the others stand
in scenes/ and povray/. What is drawn at random is the same on every machine.
"""

import dataclasses
import math
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
WRITTEN = ("table", "trees", "matdemo", "extreme")
FILL = 0.11


# A scene without a language -----------------------------------------------------------------------------------------------------

@dataclasses.dataclass
class Ball:
    radius: float
    centre: tuple = (0, 0, 0)
    colour: tuple = None


@dataclasses.dataclass
class Cube:
    """From -1 to 1."""


@dataclasses.dataclass
class Named:
    """What was defined under this name."""
    name: str
    colour: tuple = None


@dataclasses.dataclass
class Place:
    """Scaled, turned about x, y and z in turn (degrees), moved."""
    scale: float
    turn: tuple
    move: tuple


@dataclasses.dataclass
class Operation:
    """`difference`: the first part less the others; `intersection` and `union` of all."""
    kind: str
    parts: list
    place: Place = None
    colour: tuple = None  # of all parts without one


@dataclasses.dataclass
class Scene:
    definitions: dict
    solids: list


# All are seen from the origin: a cube from (-1, -1, 3) to (1, 1, 5), whose front fills the height of the picture.
MIDDLE = (0, 0, 4)
LAMP = (-3, 4, -1)
INTENSITY = 50
BACKGROUND = (0.20, 0.25, 0.35)
AMBIENT = 0.1


def random_numbers(seed=12345):
    """Uniform in [0, 1): a congruential generator, of whose 64 bits the upper ones are good."""
    state = seed
    while True:
        state = (6364136223846793005 * state + 1442695040888963407) % 2**64
        yield (state >> 11) / 2**53


def in_cube(random, half=1.0):
    return tuple(half * (2 * next(random) - 1) for _ in range(3))


def in_direction(random):
    """Uniform on the unit sphere: points of the cube are drawn until one lies in the ball."""
    while True:
        point = in_cube(random)
        length = math.hypot(*point)
        if 0.1 < length <= 1:
            return tuple(x / length for x in point)


def colour(random):
    return tuple(0.3 + 0.6 * next(random) for _ in range(3))


def plus(a, b, factor=1.0):
    return tuple(x + factor * y for x, y in zip(a, b))


def radius_of_fill(n):
    """Of n balls that together have the share FILL of the cube of edge 2."""
    return (FILL * 8 * 3 / (4 * math.pi * n)) ** (1 / 3)


def spheres(n):
    random = random_numbers()
    radius = radius_of_fill(n)
    solids = []
    for _ in range(n):
        centre, side, paint = plus(MIDDLE, in_cube(random)), in_direction(random), colour(random)
        bite = plus(centre, side, 0.7 * radius)
        solids.append(Operation("difference", [Ball(radius, centre, paint), Ball(0.8 * radius, bite, paint)]))
    return Scene({}, solids)


def pips():
    """Opposite faces have seven together. Each pip stands a little outside of its face."""
    s, d = 0.5, 1.05
    one = [(0, d, 0)]
    six = [(x, -d, z) for x in (-s, s) for z in (-s, 0, s)]
    five = [(x, y, -d) for x in (-s, s) for y in (-s, s)] + [(0, 0, -d)]
    two = [(-s, -s, d), (s, s, d)]
    three = [(-d, y, y) for y in (-s, 0, s)]
    four = [(d, y, z) for y in (-s, s) for z in (-s, s)]
    return Operation("union", [Ball(0.2, at) for at in one + six + five + two + three + four])


def fifty_two_dice():
    """In a lattice of 4 × 4 × 4 cells, of which twelve stay empty."""
    random = random_numbers()
    cells = [(x, y, z) for z in range(4) for y in range(4) for x in range(4)]
    while len(cells) > 52:
        cells.pop(int(next(random) * len(cells)))
    dice = []
    for cell in cells:
        middle = plus(MIDDLE, tuple(0.5 * i - 0.75 for i in cell))
        place = Place(0.175, tuple(360 * next(random) for _ in range(3)), middle)
        dice.append(Operation("difference", [Named("body", colour(random)), Named("pips", (0.05, 0.05, 0.05))], place))
    return {"body": Operation("intersection", [Cube(), Ball(1.4)]), "pips": pips()}, dice


def dice():
    return Scene(*fifty_two_dice())


def dice_cut():
    definitions, dice = fifty_two_dice()
    return Scene(definitions, [Operation("difference", [Operation("union", dice), Ball(1, (0, 0.2, 3.1), (0.6, 0.5, 0.3))])])


def cheese(n):
    random = random_numbers()
    radius = radius_of_fill(n)
    holes = [Ball(radius, in_cube(random)) for _ in range(n)]
    return Scene({}, [Operation("difference", [Cube(), *holes], Place(0.75, (-25, 30, 0), MIDDLE), (0.9, 0.75, 0.35))])


# Two languages ------------------------------------------------------------------------------------------------------------------

def number(x):
    return format(x, ".9g")


def numbers(v):
    return ",".join(map(number, v))


class Lapidary:
    """Ours."""
    KINDS = {"difference": "subtraction", "intersection": "intersection", "union": "union"}

    # There are no highlights: an exponent that narrows them to nothing.
    @staticmethod
    def paint(node):
        return "" if node.colour is None else f"colour({numbers(node.colour)});shininess(1e9);"

    def material(self, node):
        return "" if node.colour is None else f"material{{solid{{{self.paint(node)}}}}}"

    def scene(self, scene):
        yield f"background({numbers(BACKGROUND)});"
        yield "camera { screen { size(8/9, 2/3); } rays(1); }"
        yield f"lights {{ ambient {{ intensity({AMBIENT}); }} point {{ location({numbers(LAMP)}); intensity({INTENSITY}); }} }}"
        for name, node in scene.definitions.items():
            yield f"{self.KINDS[node.kind]} {name} {{ {self.parts(node)} }}"
        yield "objects {"
        yield from map(self.node, scene.solids)
        yield "}"

    def parts(self, operation):
        return "\n".join(map(self.node, operation.parts))

    def node(self, node):
        match node:
            case Ball():
                move = f"transform{{translate({numbers(node.centre)});}}" if any(node.centre) else ""
                return f"sphere{{radius({number(node.radius)});{self.paint(node)}{move}}}"
            case Cube():
                return "cube{}"
            case Named():
                return f"union{{{node.name};{self.material(node)}}}"
            case Operation():
                return f"{self.KINDS[node.kind]}{{{self.parts(node)}{self.material(node)}{self.place(node.place)}}}"

    @staticmethod
    def place(place):
        if place is None:
            return ""
        x, y, z = (f"{number(angle)}deg" for angle in place.turn)
        return f"transform{{scale({number(place.scale)});rotx({x});roty({y});rotz({z});translate({numbers(place.move)});}}"


class PovRay:
    @staticmethod
    def paint(node):
        return "" if node.colour is None else f" pigment{{rgb<{numbers(node.colour)}>}}"

    def scene(self, scene):
        yield "#version 3.7;"
        yield "global_settings { assumed_gamma 1.0 ambient_light rgb 1 max_trace_level 10 adc_bailout 0.001 }"
        yield '#include "common.inc"'
        yield f"background {{ rgb <{numbers(BACKGROUND)}> }}"
        yield f"PointLight(<{numbers(LAMP)}>, {INTENSITY})"
        for name, node in scene.definitions.items():
            yield f"#declare {name} = {node.kind} {{ {self.parts(node)} }}"
        yield from map(self.node, scene.solids)

    def parts(self, operation):
        return "\n".join(map(self.node, operation.parts))

    def node(self, node):
        match node:
            case Ball():
                return f"sphere{{<{numbers(node.centre)}>,{number(node.radius)}{self.paint(node)}}}"
            case Cube():
                return "box{-1,1}"
            case Named():
                return f"object{{{node.name}{self.paint(node)}}}"
            case Operation():
                return f"{node.kind}{{{self.parts(node)}{self.paint(node)}{self.place(node.place)}}}"

    @staticmethod
    def place(place):
        if place is None:
            return ""
        x, y, z = map(number, place.turn)
        return f" scale {number(place.scale)} rotate x*{x} rotate y*{y} rotate z*{z} translate <{numbers(place.move)}>"


LANGUAGES = {".scene": Lapidary(), ".pov": PovRay()}


GENERATED = re.compile(r"(dice|dice-cut|(spheres|cheese)-([1-9]\d*))")


def check(name):
    if name not in WRITTEN and not GENERATED.fullmatch(name):
        raise ValueError(f"no workload '{name}': there are spheres-N, dice, dice-cut, cheese-N, {', '.join(WRITTEN)}")


def describe(name):
    """The scene of that name, which is none of the written ones."""
    _, many, n = GENERATED.fullmatch(name).groups()
    if many:
        return {"spheres": spheres, "cheese": cheese}[many](int(n))
    return {"dice": dice, "dice-cut": dice_cut}[name]()


def files(name, folder):
    """Our scene and POV-Ray's, written to the folder unless they are there already."""
    if name in WRITTEN:
        return HERE / "scenes" / f"{name}.scene", HERE / "povray" / f"{name}.pov"
    check(name)
    paths = tuple(folder / (name + suffix) for suffix in LANGUAGES)
    for path in paths:
        if not path.exists():
            # In a process of its own: the peak memory of a process counts what its parent held when it began.
            subprocess.run([sys.executable, __file__, name, path], check=True)
    return paths


def main():
    path = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else None
    if path is None or path.suffix not in LANGUAGES or sys.argv[1] in WRITTEN:
        sys.exit(__doc__)
    try:
        check(sys.argv[1])
    except ValueError as error:
        sys.exit(f"workloads: {error}")
    scene = describe(sys.argv[1])
    path.write_text("\n".join(LANGUAGES[path.suffix].scene(scene)) + "\n")


if __name__ == "__main__":
    main()
