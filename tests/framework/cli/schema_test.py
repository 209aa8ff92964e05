"""The schema of `tomlin schema`, held against scenes by a validator of others (python3-jsonschema):
what is shipped validates, what is broken is refused at its place, and what the program accepts the
schema accepts too.

    schema_test.py SOURCE_DIR PROGRAM
"""

import concurrent.futures
import copy
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

try:
    import jsonschema
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SOURCE = None
PROGRAM = None

SCENE = """
[scene]
name = "a ring"

[parameters]
N = 8
R = 1.0

[[body]]
name = "ring"
type = "ring"
count = "N"
radius = "R"
particle_mass = "1 / N"
centre = [0.0, "R"]

[[force]]
type = "harmonic_bonds"
pairs = "all"
stiffness = 100.0

[[force]]
name = "driver"
type = "driving_spring"
body = "ring"
stiffness = 2.0
velocity = [1e-2, 0.0]

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-3 }

[measure]
from = 1.0

[output]
every = 1.0
"""

DURATION = "duration = 10.0"
INTEGRATOR = 'integrator = { type = "rk4", dt = 1e-3 }'
CENTRE = 'centre = [0.0, "R"]'

# Each row has a fault, a text of SCENE and its replacement, and the table or value at fault.
BROKEN = [
    ("unknown table", "[measure]", "[mesure]", []),
    ("unknown key of a table", "from = 1.0", "form = 1.0", ["measure"]),
    ("unknown key of the scene", 'name = "a ring"', 'title = "a ring"', ["scene"]),
    ("unknown key of a body", CENTRE, CENTRE + "\nraduis = 1.0", ["body", 0]),
    ("unknown key of a force", "amplitude = 0.1", "amplitude = 0.1\ndecey = 1.0", ["force", 2]),
    ("key of another force", "amplitude = 0.1", 'amplitude = 0.1\npairs = "all"', ["force", 2]),
    ("unknown key of an integrator", "dt = 1e-3", "dt = 1e-3, tolerance = 1.0",
     ["run", "integrator"]),
    ("key of the run elsewhere", "every = 1.0", "every = 1.0\nseed = 1", ["output"]),
    ("no such body", 'type = "ring"', 'type = "rign"', ["body", 0, "type"]),
    ("no such force", "sinusoidal_substrate", "sinusoidal", ["force", 2, "type"]),
    ("no such integrator", '"rk4"', '"rk5"', ["run", "integrator", "type"]),
    ("a force in place of a body", 'type = "ring"', 'type = "harmonic_bonds"',
     ["body", 0, "type"]),
    ("no type", 'type = "harmonic_bonds"\n', "", ["force", 0]),
    ("missing key of a body", 'count = "N"\n', "", ["body", 0]),
    ("missing key of a force", "stiffness = 100.0\n", "", ["force", 0]),
    ("missing key of an integrator", ", dt = 1e-3", "", ["run", "integrator"]),
    ("missing duration", DURATION, "", ["run"]),
    ("missing integrator", INTEGRATOR, "", ["run"]),
    ("neither duration nor max", DURATION,
     'until = { steady = "driver.mean_force.x", tolerance = 1e-3 }', ["run"]),
    ("an error without its mean", DURATION, DURATION + "\nuntil = { error = 0.01 }",
     ["run", "until"]),
    ("two ways to choose steps", DURATION, DURATION + "\naccuracy = 1e-3", ["run"]),
    ("no body", SCENE[SCENE.index("[[body]]"):SCENE.index("[[force]]")], "", []),
    ("no run", "[run]\n" + DURATION + "\n" + INTEGRATOR, "", []),
    ("a table in place of a list", "[[body]]", "[body]", ["body"]),
    ("a list in place of a table", "[run]", "[[run]]", ["run"]),
    ("a switch in place of a number", 'count = "N"', "count = true", ["body", 0, "count"]),
    ("a fraction in place of an integer", 'count = "N"', "count = 2.5", ["body", 0, "count"]),
    ("a number in place of a vector", "velocity = [1e-2, 0.0]", "velocity = 1e-2",
     ["force", 1, "velocity"]),
    ("a text in place of a vector", CENTRE, 'centre = "R"', ["body", 0, "centre"]),
    ("a vector of four", CENTRE, "centre = [0, 0, 0, 0]", ["body", 0, "centre"]),
    ("an empty vector", CENTRE, "centre = []", ["body", 0, "centre"]),
    ("a text in place of a switch", DURATION, DURATION + '\nledger = "yes"', ["run", "ledger"]),
    ("a text in place of a table", INTEGRATOR, 'integrator = "rk4"', ["run", "integrator"]),
    ("a date in place of a number", DURATION, "duration = 2024-01-01", ["run", "duration"]),
    ("a number in place of a text", 'name = "a ring"', "name = 1", ["scene", "name"]),
    ("a list in place of a parameter", "N = 8", "N = [8]", ["parameters", "N"]),
    ("wrong word", DURATION, DURATION + '\ndynamics = "inertal"', ["run", "dynamics"]),
    ("wrong word of a body", CENTRE, CENTRE + '\ncoordinates = "ridig"',
     ["body", 0, "coordinates"]),
    ("wrong word beside a list", 'pairs = "all"', 'pairs = "al"', ["force", 0, "pairs"]),
    ("wrong word in a list", CENTRE, CENTRE + '\nhold = ["w"]', ["body", 0, "hold", 0]),
    ("a word twice", CENTRE, CENTRE + '\nhold = ["x", "x"]', ["body", 0, "hold"]),
    ("a pair of three", 'pairs = "all"', "pairs = [[0, 1, 2]]", ["force", 0, "pairs", 0]),
    ("a word of another version", "[parameters]", 'units = "real"\n[parameters]',
     ["scene", "units"]),
    ("out of range", "stiffness = 100.0", "stiffness = -1.0", ["force", 0, "stiffness"]),
    ("out of range, at its open end", DURATION, "duration = 0", ["run", "duration"]),
    ("out of range, one of several", 'particle_mass = "1 / N"', "particle_mass = [1.0, -1.0]",
     ["body", 0, "particle_mass", 1]),
    ("negative seed", DURATION, DURATION + "\nseed = -1", ["run", "seed"]),
    ("an unknown key of a sweep", "[parameters]", "[sweep]\novre = {}\n[parameters]", ["sweep"]),
    ("a number for an axis", "[parameters]", "[sweep]\nover = { R = 1.0 }\n[parameters]",
     ["sweep", "over", "R"]),
    ("no values for an axis", "[parameters]", "[sweep]\nover = { run.duration = [] }\n[parameters]",
     ["sweep", "over", "run", "duration"]),
    ("a text for observables", "[parameters]",
     '[sweep]\nobservables = "ring.turns"\n[parameters]', ["sweep", "observables"]),
    ("a width of nothing", "[parameters]", "[sweep]\nrefine_to = 0.1\n[parameters]", ["sweep"]),
    ("a level alone", "[parameters]", "[sweep]\nrefine = 0.5\n[parameters]", ["sweep", "refine"]),
    ("a body and bodies", 'body = "ring"', 'body = "ring"\nbodies = ["ring"]', ["force", 1]),
    ("two bodies of one that takes one", 'body = "ring"', 'bodies = ["ring", "tip"]',
     ["force", 1, "bodies"]),
    ("a place that is no particle", 'body = "ring"', "attach = { index = 3 }",
     ["force", 1, "attach"]),
    ("a reversal without a value", 'body = "ring"', 'reverse = { when = "ring.turns" }',
     ["force", 1, "reverse"]),
    ("noise without a size", DURATION, DURATION + "\nperturb = { repeats = 3 }",
     ["run", "perturb"]),
    ("an unknown key of a motion", CENTRE, CENTRE + "\nmotion = { speed = 1.0 }",
     ["body", 0, "motion"]),
    ("no name", 'name = "driver"', 'name = "a driver"', ["force", 1, "name"]),
    ("a parameter called like a function", "R = 1.0", "R = 1.0\nsin = 1.0", ["parameters"]),
    ("an empty expression", 'radius = "R"', 'radius = ""', ["body", 0, "radius"]),
]

# Only the program knows the values of expressions, and conditions on several values.
BEYOND = [
    ("unknown parameter", 'count = "N"', 'count = "M"'),
    ("no expression", 'radius = "R"', 'radius = "R +"'),
    ("an expression out of range", "stiffness = 100.0", 'stiffness = "-R"'),
    ("an expression without a value", 'radius = "R"', 'radius = "1 / 0"'),
    ("a number that is none", DURATION, "duration = inf"),
    ("no such body", 'body = "ring"', 'body = "rign"'),
    ("a name twice", 'name = "driver"', 'name = "ring"'),
    ("a word of the summary as a name", 'name = "driver"', 'name = "energy"'),
    ("two of a type without names", 'name = "driver"\ntype = "driving_spring"',
     'type = "driving_spring"\nstiffness = 1.0\nvelocity = [0.0, 0.0]\n[[force]]\n'
     'type = "driving_spring"'),
    ("a window past the end", "from = 1.0", "from = 20.0"),
    ("mixed dimensions", "velocity = [1e-2, 0.0]", "velocity = [1e-2]"),
    ("as many masses as no particles", 'particle_mass = "1 / N"', "particle_mass = [1.0, 2.0]"),
    ("a sweep over nothing", "[parameters]", "[sweep]\nover = { Q = [1] }\n[parameters]"),
    ("a grid that is none", "[parameters]", '[sweep]\nover = { R = "1:2" }\n[parameters]'),
    ("a level that is none", "[parameters]",
     '[sweep]\nover = { R = [1, 2] }\nrefine = "ring.turns=x"\n[parameters]'),
    ("a particle that is not there", 'pairs = "all"', "pairs = [[0, 9]]"),
    ("positions without samples", "every = 1.0", "trajectory = true"),
]

# Values of every kind that a key may take, or not, as they are written.
VALUES = ["1", "-1", "0.5", "0", '"1 + 1"', '"pi"', '"word"', "true", "[1.0]", "[0.5, 0.5]",
          '["1", 2.0]', "[true, false]", '["x"]', "[[0, 1]]", "[[0.0, 0.5], [1.0, 0.5]]",
          "{ particle = 0 }", '{ when = "bodies.ring.centre_of_mass.x", above = 1.0 }']

# Faults of a schema, each of which shows at what is shipped: a key forgotten, one asked for too
# much, a type, a range and a word too narrow. (path, what becomes of what stands there)
PLANTED = [
    (["definitions", "force.sinusoidal_substrate", "properties"], lambda p: p.pop("decay")),
    (["definitions", "force.driving_spring"], lambda d: d["required"].append("start")),
    (["definitions", "body.ring", "properties", "radius"], lambda p: p.update(type="number")),
    (["definitions", "force.harmonic_bonds", "properties", "stiffness"],
     lambda p: p.update(exclusiveMaximum=1.0)),
    (["definitions", "integrator", "properties", "type", "enum"], lambda e: e.remove("dopri5")),
    (["properties", "run", "properties", "dynamics", "enum"], lambda e: e.remove("overdamped")),
    (["properties", "run", "else", "else"], lambda e: e["required"].append("accuracy")),
    (["properties"], lambda p: p.pop("measure")),
]


def ask(*arguments, folder=None):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False,
                          cwd=folder, timeout=300)


def validator_of(schema):
    return jsonschema.Draft7Validator(schema)


def planted(document, path, value):
    """A copy with a value at this path; without what is there where the value is None."""
    copied = copy.deepcopy(document)
    table = copied
    for part in path[:-1]:
        table = table[part]
    if value is None:
        del table[path[-1]]
    else:
        table[path[-1]] = value
    return copied


def files_of(*patterns):
    return sorted(file for pattern in patterns for file in SOURCE.glob(pattern))


def parsed(text):
    """None where it is no TOML."""
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):
        return None


def with_setting(scene, path, key, value):
    """The scene with a value at a place, as --set puts it there."""
    if (path, key) == (["run"], "accuracy"):
        del scene["run"]["integrator"]  # in whose place it stands
    place = scene
    for step in path:
        if isinstance(place, list):
            place = next(one for one in place if step in (one.get("name"), one["type"]))
        else:
            place = place.setdefault(step, {})
    place[key] = tomllib.loads("value = " + value)["value"]
    return scene


def raw_strings(file):
    """The raw strings of a C++ file that look like scenes."""
    text = file.read_text(encoding="utf-8")
    return [raw for raw in re.findall(r'R"\w*\((.*?)\)\w*"', text, flags=re.DOTALL)
            if "[[body]]" in raw or "body = [" in raw]


def scenes_of_tests():
    """(where, text) of every scene that stands in a file of the tests."""
    for file in files_of("tests/**/*.toml"):
        try:
            yield file, file.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            pass
    for file in files_of("tests/**/*.cpp", "tests/**/*.hpp"):
        for raw in raw_strings(file):
            yield file, raw


def scenes_of_pages():
    for page in files_of("README.md", "*/**/*.md"):
        if page.relative_to(SOURCE).parts[0].startswith("build"):
            continue
        blocks = re.findall(r"^```toml\n(.*?)^```", page.read_text(encoding="utf-8"),
                            flags=re.DOTALL | re.MULTILINE)
        for block in blocks:
            yield page, block


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        done = ask("schema")
        assert done.returncode == 0, done.stderr
        cls.schema = json.loads(done.stdout)
        cls.validator = validator_of(cls.schema)
        listed = json.loads(ask("describe", "--json").stdout)
        cls.components = {
            one["name"]: json.loads(ask("describe", one["name"], "--json").stdout)
            for kinds in ("bodies", "forces", "integrators") for one in listed[kinds]}

    def faults(self, scene, validator=None):
        return [f"{list(e.absolute_path)}: {e.message}"
                for e in (validator or self.validator).iter_errors(scene)]

    def refused_by_program(self, text):
        with tempfile.TemporaryDirectory(prefix="tomlin-schema-") as name:
            (pathlib.Path(name) / "scene.toml").write_text(text, encoding="utf-8")
            done = ask("check", "scene.toml", folder=name)
        return done.returncode == 2, done.stderr

    def test_it_is_a_schema(self):
        jsonschema.Draft7Validator.check_schema(self.schema)
        self.assertEqual(self.schema["$schema"], "http://json-schema.org/draft-07/schema#")

    def test_every_key_says_what_it_is(self):
        for name, component in self.components.items():
            kind = component["kind"]
            definition = self.schema["definitions"][f"{kind}.{name}"]
            self.assertEqual(definition["description"], component["summary"])
            rows = component["parameters"]
            for row in rows:
                with self.subTest(component=name, key=row["key"]):
                    described = definition["properties"][row["key"]]
                    self.assertIn(row["doc"], described["description"])
                    self.assertIn(row["admissible"], described["description"])
                    if row["dimension"] != "1":
                        self.assertIn(f"[{row['dimension']}]", described["description"])
                    # Defaults in parts of a scene's length or time are no numbers of a schema.
                    if row["default"] is not None and (row["dimension"] == "1" or
                                                       "default" in described):
                        self.assertEqual(described["default"], row["default"])
            self.assertEqual(set(definition.get("required", [])),
                             {row["key"] for row in rows if row["required"]})
            own = {key["key"] for key in component["other_keys"]}
            self.assertEqual(set(definition["properties"]), own | {row["key"] for row in rows})

    def test_defaults_are_admissible(self):
        for name, definition in self.schema["definitions"].items():
            for key, described in definition["properties"].items():
                if "default" in described:
                    with self.subTest(component=name, key=key):
                        self.assertEqual(self.faults(described["default"],
                                                     validator_of(described)), [])

    def test_what_is_shipped_validates(self):
        files = files_of("scenarios/*/*.toml", "framework/cli/templates/*.toml")
        self.assertGreater(len(files), 30)
        for file in files:
            with self.subTest(file=str(file)):
                self.assertEqual(self.faults(tomllib.loads(file.read_text(encoding="utf-8"))), [])

    def test_pages_validate(self):
        scenes = list(scenes_of_pages())
        self.assertGreater(len(scenes), 1)
        for page, block in scenes:
            with self.subTest(page=str(page), begins=block[:60]):
                self.assertEqual(self.faults(tomllib.loads(block)), [])

    def test_examples_and_their_effective_scenes_validate(self):
        with tempfile.TemporaryDirectory(prefix="tomlin-schema-") as name:
            folder = pathlib.Path(name)
            for component, described in self.components.items():
                with self.subTest(component=component):
                    self.assertEqual(self.faults(tomllib.loads(described["example"])), [])
                    (folder / "scene.toml").write_text(described["example"], encoding="utf-8")
                    done = ask("run", "scene.toml", "--quiet", "-o", component, folder=name)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    effective = (folder / component / "scene.toml").read_text(encoding="utf-8")
                    self.assertEqual(self.faults(tomllib.loads(effective)), [])

    def test_broken_scenes_are_refused_at_their_place(self):
        self.assertEqual(self.faults(tomllib.loads(SCENE)), [])
        for why, old, new, place in BROKEN:
            with self.subTest(why):
                self.assertEqual(SCENE.count(old), 1, old)
                text = SCENE.replace(old, new)
                errors = list(self.validator.iter_errors(tomllib.loads(text)))
                self.assertIn(place, [list(error.absolute_path) for error in errors])
                refused, _ = self.refused_by_program(text)
                self.assertTrue(refused)

    def test_faults_are_told_of_the_type_that_is_meant(self):
        """A misspelt key is one fault, not one for each component."""
        for why in ("unknown key of a body", "unknown key of a force",
                    "unknown key of an integrator", "missing key of a force"):
            old, new = next((o, n) for w, o, n, _ in BROKEN if w == why)
            with self.subTest(why):
                self.assertEqual(len(self.faults(tomllib.loads(SCENE.replace(old, new)))), 1)

    def test_the_rest_is_the_programs(self):
        """The line between the two: where the schema learns one of these, it moves up."""
        for why, old, new in BEYOND:
            with self.subTest(why):
                self.assertEqual(SCENE.count(old), 1, old)
                text = SCENE.replace(old, new)
                self.assertEqual(self.faults(tomllib.loads(text)), [])
                refused, message = self.refused_by_program(text)
                self.assertTrue(refused, message)

    def test_plugins_are_a_list_of_names(self):
        for plugins, sound in (("[]", True), ('[""]', False), ('"lib.so"', False), ("[1]", False)):
            with self.subTest(plugins):
                text = f"plugins = {plugins}\n" + SCENE
                refused, message = self.refused_by_program(text)
                self.assertEqual(refused, not sound, message)
                self.assertEqual(self.faults(tomllib.loads(text)) == [], sound)

    def test_what_the_program_accepts_validates(self):
        """Over all scenes that stand in tests, sound and broken."""
        valid = refused = 0
        for where, text in scenes_of_tests():
            scene = parsed(text)
            if scene is None:
                continue
            faults = self.faults(scene)
            if not faults:
                valid += 1
                continue
            by_program, _ = self.refused_by_program(text)
            refused += by_program
            with self.subTest(where=str(where), begins=text[:80]):
                self.assertTrue(by_program, faults)
        print(f"scenes in tests: {valid} validate, {refused} are refused by schema and program")
        self.assertGreater(valid, 20)
        self.assertGreater(refused, 10)

    def test_what_the_program_accepts_of_each_key_validates(self):
        """Every key of components and tables, with values of every kind; one of those that are
        declared in the same words, as dt in most integrators."""
        sections = [(["run", "integrator"] if c["kind"] == "integrator" else [c["kind"], name],
                     c["example"], c["parameters"]) for name, c in self.components.items()]
        for table in json.loads(ask("describe", "--json").stdout)["tables"]:
            rows = json.loads(ask("describe", table["name"], "--json").stdout)["parameters"]
            sections.append((table["name"].split("."), SCENE, rows))
        accepted = 0
        asked = []
        seen = set()
        with tempfile.TemporaryDirectory(prefix="tomlin-schema-") as name:
            for number, (path, text, rows) in enumerate(sections):
                file = pathlib.Path(name) / f"{number}.toml"
                file.write_text(text, encoding="utf-8")
                for row in rows:
                    declared = json.dumps([path[0], row], sort_keys=True)
                    if declared in seen:
                        continue
                    seen.add(declared)
                    for value in VALUES + [json.dumps(word) for word in row["choices"]]:
                        scene = with_setting(tomllib.loads(text), path, row["key"], value)
                        faults = self.faults(scene)
                        accepted += not faults
                        if faults:
                            setting = ".".join([*path, row["key"]]) + "=" + value
                            asked.append((file, setting, faults))
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                ended = list(pool.map(lambda one: ask("check", str(one[0]), "--set", one[1]), asked))
        for done, (_, setting, faults) in zip(ended, asked):
            with self.subTest(setting=setting):
                self.assertEqual(done.returncode, 2, faults)
        refused = sum(done.returncode == 2 for done in ended)
        print(f"values of keys: {accepted} validate, {refused} are refused by schema and program")
        self.assertGreater(accepted, 300)
        self.assertGreater(refused, 500)

    def test_a_wrong_schema_shows(self):
        scenes = [tomllib.loads(file.read_text(encoding="utf-8"))
                  for file in files_of("scenarios/*/*.toml")]
        for path, plant in PLANTED:
            wrong = copy.deepcopy(self.schema)
            place = wrong
            for key in path:
                place = place[key]
            plant(place)
            validator = validator_of(wrong)
            with self.subTest(path=path):
                self.assertTrue(any(self.faults(scene, validator) for scene in scenes))

    def test_it_is_written_to_a_file(self):
        with tempfile.TemporaryDirectory(prefix="tomlin-schema-") as name:
            self.assertEqual(ask("schema", "-o", "s.json", folder=name).returncode, 0)
            written = json.loads((pathlib.Path(name) / "s.json").read_text(encoding="utf-8"))
            self.assertEqual(written, self.schema)
            again = ask("schema", "-o", "s.json", folder=name)
            self.assertEqual(again.returncode, 2)
            self.assertIn("the file is there already", again.stderr)
            self.assertEqual(ask("schema", "-o", "s.json", "--force", folder=name).returncode, 0)


class Summaries(unittest.TestCase):
    """`tomlin schema --summary` against what runs leave."""

    SCENES = [
        ("scenarios/rolling_ring/table_1_rigid.toml", ["--set", "run.ledger=true"]),
        ("scenarios/prandtl_tomlinson/stick_slip.toml", ["--set", "run.accuracy=1e-3"]),
        ("scenarios/prandtl_tomlinson/stick_slip.toml",
         ["--set", "run.dynamics=quasistatic", "--set",
          "run.perturb={size=1e-9,repeats=2}"]),
        ("scenarios/prandtl_tomlinson/stick_slip.toml",
         ["--set", "run.integrator={type=\"rk4\",dt=100.0}"]),  # fails
        ("scenarios/rolling_ring/table_1_rigid.toml",
         ["--set", 'measure.observables=["forces.driver.on.ring.mean_force.x", "ring.turns"]']),
    ]

    @classmethod
    def setUpClass(cls):
        cls.validator = validator_of(json.loads(ask("schema", "--summary").stdout))
        cls.validator.check_schema(cls.validator.schema)
        cls.summaries = []
        with tempfile.TemporaryDirectory() as folder:
            for number, (scene, options) in enumerate(cls.SCENES):
                out = pathlib.Path(folder, str(number))
                subprocess.run([PROGRAM, "run", SOURCE / scene, *options, "-o", out],
                               capture_output=True, timeout=300)
                cls.summaries.append(json.loads((out / "summary.json").read_text()))

    def test_summaries_validate(self):
        for summary, (scene, options) in zip(self.summaries, self.SCENES):
            faults = [fault.message for fault in self.validator.iter_errors(summary)]
            self.assertEqual(faults, [], f"{scene} {options}")

    def test_every_quantity_is_there(self):
        self.assertIn("numerical_work", self.summaries[0]["energy"])
        self.assertIn("equilibrium", self.summaries[2])
        self.assertEqual(self.summaries[3]["status"], "failed")
        self.assertIn("mean_force", self.summaries[4]["forces"]["driver"]["on"]["ring"])
        self.assertEqual(list(self.summaries[4]["bodies"]["ring"]), ["turns"])

    def test_planted_faults_are_seen(self):
        for path, value in ((("time", "steps"), None), (("bodies", "ring", "velocty"), [0.0]),
                            (("events", "slips"), "many"), (("time", "steps"), 0.5)):
            self.assertFalse(self.validator.is_valid(planted(self.summaries[0], path, value)), path)


class Sweeps(unittest.TestCase):
    """`tomlin schema --sweep` against what sweeps leave."""

    def test_they_validate_and_planted_faults_are_seen(self):
        validator = validator_of(json.loads(ask("schema", "--sweep").stdout))
        validator.check_schema(validator.schema)
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(
                [PROGRAM, "sweep", SOURCE / "scenarios/prandtl_tomlinson/stick_slip.toml",
                 "--over", "v=0.1:0.3:3", "--over", "run.dynamics=inertial,overdamped",
                 "--over", "run.integrator.relative_tolerance=1e-6,-1",
                 "--observable", "driver.mean_force.x", "-o", folder,
                 "--refine", "driver.mean_force.x=1.3", "--refine-along", "v"],
                capture_output=True, check=True)
            sweep = json.loads(pathlib.Path(folder, "sweep.json").read_text())
        self.assertEqual([fault.message for fault in validator.iter_errors(sweep)], [])
        self.assertEqual(sweep["counts"]["refused"], 6)
        self.assertEqual([one["status"] for one in sweep["refine"]["intervals"]],
                         ["found", "none", "found", "none"])
        for key in set(sweep) - {"refine"}:
            self.assertFalse(validator.is_valid(planted(sweep, (key,), None)), key)
        for path, value in ((("points",), 1.5), (("axes", 0, "spacing"), "cubic"),
                            (("axes", 0, "from"), "0.1"), (("counts", "unknown"), 1),
                            (("observables", 0, "unit"), 1), (("status",), "failed"),
                            (("refine", "intervals", 0, "status"), "lost"),
                            (("refine", "intervals", 0, "interval"), [1.0]),
                            (("refine", "intervals", 1, "values"), [1.0, 2.0]),
                            (("refine", "level"), "0.5")):
            self.assertFalse(validator.is_valid(planted(sweep, path, value)), path)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    SOURCE = pathlib.Path(sys.argv[1]).resolve()
    PROGRAM = str(pathlib.Path(sys.argv[2]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
