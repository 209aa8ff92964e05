"""Scenes: read, changed, written; faults."""

import copy
import pickle

import numpy as np
import pytest

import tomlin

TEXT = """
[[body]]
name = "tip"
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.5]

[[force]]
type = "viscous_damping"
coefficient = 3.0

[run]
duration = 40.0
integrator = { type = "dopri5" }
"""


def as_dict():
    return {
        "body": [{"name": "tip", "type": "point", "position": np.zeros(1),
                  "particle_mass": np.float64(1.0)}],
        "force": [{"name": "driver", "type": "driving_spring", "stiffness": 2.0,
                   "velocity": [np.float32(0.5)]},
                  {"type": "viscous_damping", "coefficient": 3.0}],
        "run": {"duration": 40.0, "integrator": {"type": "dopri5"}},
    }


def test_dict_and_text_are_the_same_scene():
    assert tomlin.parse(as_dict()).to_toml() == tomlin.parse(TEXT).to_toml()
    assert tomlin.parse(tomlin.parse(TEXT).to_dict()).to_toml() == tomlin.parse(TEXT).to_toml()


def test_values_of_other_types():
    from pathlib import Path

    document = as_dict()
    for mass in (np.float32(1), np.int8(1), np.longdouble(1), np.array(1.0), 1):
        document["body"][0]["particle_mass"] = mass
        assert tomlin.parse(document).to_dict() == tomlin.parse(TEXT).to_dict()
    document["body"][0]["position"] = (0.0,)
    document["run"]["ledger"] = np.bool_(True)
    assert tomlin.parse(document).run()["energy.work_in"] > 0.0
    document["body"] = [{"name": "tip", "type": "particles", "particle_mass": 1.0,
                         "file": Path("none.xyz")}]
    with pytest.raises(tomlin.SceneError, match="none.xyz"):
        tomlin.parse(document)


@pytest.mark.parametrize("value", [None, b"1.0", 1j, {1.0}, object(), [1.0, None], {"x": None}])
def test_values_that_a_scene_has_not(tip, value):
    document = as_dict()
    document["body"][0]["particle_mass"] = value
    with pytest.raises(TypeError, match="body.particle_mass"):
        tomlin.parse(document)
    with pytest.raises(TypeError, match="^v"):
        tip.set("v", value)
    with pytest.raises(TypeError, match="^v"):
        tomlin.sweep(tip, {"v": [value]}, "driver.mean_force.x")


@pytest.mark.parametrize("value", [True, [1.0], [[1.0]], {"x": 1.0}, float("nan"), "", 10**400])
def test_values_of_the_wrong_kind_have_a_key(tip, value):
    document = as_dict()
    document["body"][0]["particle_mass"] = [value]
    for call in (lambda: tomlin.parse(document), lambda: tip.set("m", value)):
        with pytest.raises(tomlin.SceneError) as raised:
            call()
        fault = raised.value.faults[0]
        assert fault.code and fault.message and fault.file
        # A text that is no TOML has no key.
        no_toml = fault.code in ("scene.syntax", "scene.out_of_range") and not fault.key
        assert no_toml or fault.key.split(".")[-1] in ("m", "particle_mass")


def test_set_returns_a_new_scene(tip):
    other = tip.set("v", 0.02)
    assert (tip.parameters["v"], other.parameters["v"]) == (0.01, 0.02)
    assert other.set("v", 0.01).to_toml() == tip.to_toml()
    assert tip.set({"run.integrator": {"type": "rk4", "dt": 0.01}}).to_dict()["run"]["integrator"][
        "type"] == "rk4"
    assert tip.set("v", np.float64(0.1)).parameters["v"] == 0.1
    assert tip.set("force.driver.velocity", np.array([0.3])).to_dict()["force"][0]["velocity"] == [0.3]


def test_numbers_keep_their_bits():
    scene = tomlin.parse("[parameters]\nnumber = 1.0\n" + TEXT)
    for number in (0.1, 1 / 3, 5e-324, 1.7976931348623157e308, -1e-17, 2**53 + 1):
        assert scene.set("number", number).parameters["number"] == float(number)


def test_all_faults_come_together():
    with pytest.raises(tomlin.SceneError) as raised:
        tomlin.parse(TEXT.replace("stiffness", "stifness").replace("coefficient", "coeficient"),
                     "typos.toml")
    faults = raised.value.faults
    assert len(faults) >= 2
    fault = next(one for one in faults if one.code == "scene.unknown_key")
    assert (fault.file, fault.line, fault.column) == ("typos.toml", 11, 1)
    assert fault.key == "force.driver.stifness" and fault.nearest == "stiffness"
    assert str(fault) in str(raised.value) and fault.message and fault.text
    assert isinstance(raised.value, ValueError)
    assert pickle.loads(pickle.dumps(raised.value)).faults == faults


@pytest.mark.parametrize("bad, code", [
    ("x = [", "scene.syntax"), ("", "file.invalid"), ("a = 1\na = 2", "scene.duplicate_key"),
    ("\udcff", None)])
def test_texts_that_are_none(bad, code):
    with pytest.raises((tomlin.SceneError, TypeError)) as raised:
        tomlin.parse(bad)
    if code:
        assert raised.value.faults[0].code == code


@pytest.mark.parametrize("call", [
    lambda tip: tip.set("v", object()), lambda tip: tip.set("v", None), lambda tip: tip.set("v", {1: 2}),
    lambda tip: tip.run(progress=3, threads="two"), lambda tip: tomlin.parse(3),
    lambda tip: tomlin.load(None), lambda tip: tomlin.parse(b"x = 1"), lambda tip: tomlin.parse([1]),
    lambda tip: tip.set(3, 4), lambda tip: tomlin.compare([tip, 3], "driver.mean_force.x"),
    lambda tip: tomlin.sweep("tip", {"v": [0.1]}, "x"), lambda tip: tomlin.sweep(tip, [0.1], "x"),
    lambda tip: tomlin.Simulation("tip"), lambda tip: tip.simulation().advance(steps=1.5),
    lambda tip: tip.run(folder=3), lambda tip: tip.check(seed="a"), lambda tip: tomlin.sweep(tip, {"v": 1j}, "driver.mean_force.x"),
    lambda tip: tip.run()[3]])
def test_wrong_types(tip, call):
    with pytest.raises((TypeError, AttributeError)):
        call(tip)


def test_settings_that_are_refused(tip):
    for path, value in (("nothing", 1.0), ("run.duration", -1.0), ("v", "1/0"), ("v", float("nan")),
                        ("run.integrator.type", "rk5")):
        with pytest.raises(tomlin.SceneError):
            tip.set(path, value)


def test_missing_files(tmp_path):
    for call in (lambda: tomlin.load(tmp_path / "none.toml"), lambda: tomlin.load(tmp_path)):
        with pytest.raises(tomlin.SceneError) as raised:
            call()
        assert raised.value.faults[0].code.startswith("file.")
    with pytest.raises(tomlin.OutputError, match="none"):
        tomlin.open(tmp_path / "none")
    (tmp_path / "summary.json").write_text("{")
    with pytest.raises(tomlin.OutputError, match="no summary"):
        tomlin.open(tmp_path)


def test_studies_are_objects(tip):
    explanation = tip.explain(seconds=0.01)
    assert explanation.sliding[0].stick_slip == pytest.approx(5.0, rel=1e-12)
    assert explanation["integrator"]["type"] == "dopri5" and explanation._repr_html_()
    check = tip.check()
    assert check and check.holds and not check.failed and len(check.checks) > 10
    quick = tip.set({"run.duration": 100.0, "run.integrator": {"type": "rk4", "dt": 0.01},
                     "measure.from": 50.0, "measure.to": 100.0, "measure.in": "time"})
    tradeoff = quick.tradeoff("driver.mean_force.x", tolerance=1e-3, budget=600.0)
    best = tradeoff.recommended()
    truth = tradeoff.reference.value
    assert best.run()["driver.mean_force.x"] == pytest.approx(truth, rel=1e-3)
    assert tradeoff._repr_html_()
    both = tomlin.compare([quick, best], "driver.mean_force.x")
    assert {one.verdict for one in both.models} <= {"reference", "agrees", "undecided"}
    assert len(both.curves[0][0]) > 10 and both.plot().lines
    with pytest.raises(tomlin.SceneError):
        tomlin.compare([quick, tomlin.parse(TEXT)], "driver.mean_force.x")


def test_copies_keep_the_sweep(tip):
    """By which points are continued from their neighbours here: with other numbers."""
    force = "driver.mean_force.x"
    scene = tomlin.parse(tip.to_toml() + f'\n[sweep]\nobservables = ["{force}"]\n'
                         "continue_from_neighbour = true\nover = { v = [0.05, 0.1] }\n")
    whole = tomlin.sweep(scene)[force]
    apart = tomlin.sweep(scene, continue_from_neighbour=False)[force]
    assert whole[1] != apart[1] and apart[1] == tip.set("v", 0.1).run()[force]
    copies = [copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene)),
              tomlin.parse(scene.to_dict()), tomlin.parse(scene.to_toml())]
    for one in copies:
        assert one.to_toml() == scene.to_toml()
        assert (tomlin.sweep(one)[force] == whole).all()
