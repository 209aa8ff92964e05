"""Results: numbers, arrays, folders, interrupts, displays."""

import copy
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import weakref

import numpy as np
import pytest

import tomlin

ENDLESS = {"run.duration": 1e9, "run.integrator": {"type": "rk4", "dt": 0.01},
           "measure.from": 0.0, "measure.to": 1e9, "measure.in": "time", "output.every": 1e6}


def test_every_declared_quantity_by_path_and_attribute(tip):
    result = tip.run()
    quantities = result.quantities()
    assert len(quantities) > 20
    for path, (value, unit, meaning) in quantities.items():
        assert result[path] == value and meaning and isinstance(unit, str)
        family, _, short = path.partition(".")
        assert family not in ("drivers", "bodies") or result[short] == value
    assert result.driver.mean_force.x == result["drivers.driver.mean_force.x"]
    assert result.events.shape == (result.summary["events"]["slips"],)
    assert result.window.to == result["window.to"]
    assert "driver.mean_force.x" in result and "driver.mean_farce.x" not in result
    with pytest.raises(tomlin.QuantityError) as raised:
        result["driver.mean_farce.x"]
    assert raised.value.faults[0].nearest == "driver.mean_force.x"
    assert isinstance(raised.value, KeyError)
    with pytest.raises(AttributeError):
        result.no_such_thing
    assert "driver" in dir(result) and np.asarray(result["driver.mean_force"]).shape == (1,)


def test_errors_and_determined_by_path(tip):
    accurate = tip.set("run.accuracy", 1e-3).run()
    assert 0 < accurate["error.driver.mean_force.x"] < 1e-2
    assert "type" in accurate.accuracy.integrator and accurate.scene.to_toml()
    shaken = tip.set("run.perturb", {"size": 1e-9, "repeats": 2}).run()
    assert shaken["determined.driver.mean_force.x"].digits > 1


def test_samples_are_the_memory_of_the_run(tip):
    result = tip.run()
    samples = result.samples
    assert np.may_share_memory(samples["time"], result._run.samples())
    assert not samples.flags.writeable
    with pytest.raises(ValueError):
        samples["time"][0] = 1.0
    kept = samples["driver.force.x"]
    total = kept.sum()
    gone = weakref.ref(result)
    del result, samples
    assert gone() is None and kept.sum() == total  # the array keeps what it needs
    assert tip.run().samples.units["driver.force.x"] == "force"


def test_positions_among_samples():
    from scenes import FLEXIBLE, scene

    text = scene(FLEXIBLE, '{ type = "rk4", dt = 2e-3 }', 2.0, 0.5) + "trajectory = true\n"
    samples = tomlin.parse(text).run().samples
    assert samples["positions"].shape == (len(samples), 8, 2)
    np.testing.assert_allclose(samples["positions"].mean(axis=1)[:, 0],
                               samples["ring.centre_of_mass.x"], atol=1e-12)
    data = samples.to_xarray()
    assert data["positions"].dims == ("time", "particle", "axis")


@pytest.mark.parametrize("kind", ["h5md", "xyz"])
def test_positions_of_runs_in_folders(kind, tmp_path):
    from scenes import CHAIN, FLEXIBLE, scene

    for k, body in enumerate((FLEXIBLE, CHAIN)):  # in two dimensions, and in one
        ring = tomlin.parse(scene(body, '{ type = "rk4", dt = 2e-3 }', 2.0, 0.5)
                            + f'trajectory = true\ntrajectory_format = "{kind}"\n')
        whole = ring.run().samples
        for result in (ring.run(folder=tmp_path / str(k)), tomlin.open(tmp_path / str(k))):
            samples = result.samples
            assert samples.dtype == whole.dtype and samples.units == whole.units
            assert (samples == whole).all() and np.ptp(samples["positions"]) > 0.1
            assert not samples.flags.writeable
    file = next(tmp_path.glob("1/trajectory.*"))
    content = file.read_bytes()
    # Cut short; of other lines.
    for damaged in (content[:len(content) // 2], b"1\n\n", b"no numbers\n" + content):
        file.write_bytes(damaged)
        with pytest.raises(tomlin.OutputError) as raised:
            tomlin.open(tmp_path / "1").samples
        assert str(tmp_path / "1") in str(raised.value)
    table = tmp_path / "1" / "observables.csv"
    file.unlink()
    for damaged in (b"", b"time [time]\n1,2\n", b"time [time]\nx\n", b"time [time]\n1"):
        table.write_bytes(damaged)
        with pytest.raises(tomlin.OutputError, match="observables.csv:"):
            tomlin.open(tmp_path / "1").samples


def test_no_samples_and_no_events():
    scene = tomlin.parse({
        "body": [{"name": "tip", "type": "point", "position": [0.0], "particle_mass": 1.0}],
        "force": [{"type": "viscous_damping", "coefficient": 3.0}],
        "run": {"duration": 1.0, "integrator": {"type": "dopri5"}}})
    result = scene.run()
    assert len(result.samples) == 0 and len(result.events) == 0
    assert result._repr_html_() and str(result) and repr(result)
    with pytest.raises(ValueError, match="no samples"):
        result.plot()


def test_tables_of_others(tip):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    result = tip.run()
    frame = result.samples.to_pandas()
    assert list(frame.columns) == list(result.samples.columns) and len(frame) == len(result.samples)
    assert isinstance(result.events.to_pandas(), pandas.DataFrame)
    data = result.samples.to_xarray()
    assert data["driver.force.x"].attrs["units"] == "force" and data.sizes["time"] == len(frame)


def test_folder_open_resume_force(tip, tmp_path):
    folder = tmp_path / "run"
    result = tip.run(folder=folder)
    opened = tomlin.open(folder)
    assert opened.status == "finished" and opened.folder == folder
    assert opened["driver.mean_force.x"] == result["driver.mean_force.x"]
    assert opened.driver.mean_force.x == result.driver.mean_force.x
    assert opened.scene.to_toml() == tip.to_toml()
    with pytest.raises(tomlin.SceneError) as raised:
        tip.run(folder=folder)
    assert raised.value.faults[0].code.startswith("file.")
    assert "force=True" in str(raised.value) and str(raised.value).startswith("folder=")
    assert "--" not in str(raised.value)
    again = tip.run(folder=folder, resume=True)  # over already
    assert again["driver.mean_force.x"] == result["driver.mean_force.x"]
    with pytest.raises(tomlin.SceneError) as raised:
        tip.set("v", 0.02).run(folder=folder, resume=True)
    assert "force=True" in str(raised.value) and "--" not in str(raised.value)
    assert tip.set("v", 0.02).run(folder=folder, force=True).status == "finished"
    with pytest.raises(tomlin.QuantityError) as raised:
        opened["driver.mean_farce.x"]
    assert raised.value.faults[0].nearest == "driver.mean_force.x"
    with pytest.raises(ValueError, match="folder"):
        tip.run(resume=True)
    if os.geteuid() != 0:
        with pytest.raises((tomlin.SceneError, tomlin.OutputError)):
            tip.run(folder="/proc/none/run")


def test_interrupted_and_resumed_in_a_folder(tip, tmp_path):
    scene = tip.set({"run.integrator": {"type": "rk4", "dt": 1e-4}})  # a second
    whole = scene.run()
    with pytest.raises(KeyboardInterrupt) as raised:
        scene.run(folder=tmp_path / "run", progress=interrupt)
    part = raised.value.result
    assert part.status == "interrupted" and part["time.end"] < whole["time.end"]
    assert tomlin.open(tmp_path / "run").status == "interrupted"
    rest = scene.run(folder=tmp_path / "run", resume=True)
    assert rest.status == "finished"
    ignored = ("performance",)
    assert {k: v for k, v in rest.summary.items() if k not in ignored} == {
        k: v for k, v in whole.summary.items() if k not in ignored}


def interrupt(*_):
    """Ctrl-C while something runs: what shows progress is called a few times a second."""
    os.kill(os.getpid(), signal.SIGINT)


def test_interrupt_ends_a_run(tip):
    threading.Timer(0.5, interrupt).start()
    with pytest.raises(KeyboardInterrupt) as raised:
        tip.set(ENDLESS).run()
    result = raised.value.result
    assert result.status == "interrupted" and result["time.end"] > 0.0
    assert result["driver.mean_force.x"] is None
    with pytest.raises(tomlin.RunError):
        result.require_finished()
    # Python's own handler is in place again.
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)


def test_one_interrupt_ends_a_loop_of_runs(tip):
    begun = 0
    threading.Timer(0.3, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            begun += 1
            tip.set("v", 1e-3).run()
    assert time.monotonic() < end and begun > 0


def same(one, other):
    return np.array_equal(one.view("u1"), other.view("u1")) and one.units == other.units


def test_results_can_be_pickled_and_copied(tip, tmp_path):
    scene = tip.set({"output.every": 0.5})
    for result in (scene.run(), scene.run(folder=tmp_path / "run"),
                   tomlin.open(tmp_path / "run")):
        for other in (pickle.loads(pickle.dumps(result)), copy.copy(result),
                      copy.deepcopy(result)):
            assert other.summary == result.summary and other.status == "finished"
            assert other["driver.mean_force.x"] == result["driver.mean_force.x"]
            assert other.driver.mean_force == result.driver.mean_force
            assert other.failure is None and other.folder == result.folder
            assert len(other.samples) > 1 and same(other.samples, result.samples)
            assert not other.samples.flags.writeable
            assert (other.events == result.events).all() or not len(result.events)
            assert other.scene.to_toml() == result.scene.to_toml()
            assert other.require_finished() is other and "finished" in repr(other) and str(other)
    failed = tip.set({"force.driver.velocity": [1e3], "run.integrator": {"type": "rk4", "dt": 0.1},
                       "run.allow_unstable": True, "force.viscous_damping.coefficient": 1e-3}).run()
    again = pickle.loads(pickle.dumps(failed))
    assert failed.status == again.status == "failed"
    assert again.failure.message == failed.failure.message


def test_interrupt_ends_a_sweep(tip, tmp_path):
    scene = tip.set({"run.integrator": {"type": "rk4", "dt": 2e-4}})  # 400 points take many seconds
    over = {"v": [0.01 * (1 + 1e-3 * k) for k in range(400)]}
    with pytest.raises(KeyboardInterrupt) as raised:
        tomlin.sweep(scene, over, "driver.max_force.x", folder=tmp_path / "sweep", threads=1,
                     progress=interrupt)
    part = raised.value.result
    assert not part.complete and "interrupted" in repr(part)
    missing = part.status == "missing"
    assert missing.any() and np.isnan(part["driver.max_force.x"][missing]).all()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_interrupted_sweep_is_continued(tip, tmp_path):
    """Several times over, to the same bits as at once; rows that are there are not run again."""
    scene = tip.set({"run.integrator": {"type": "rk4", "dt": 2e-4}})
    over = {"v": np.linspace(0.01, 0.02, 100)}
    rows = []
    for _ in range(1000):
        try:
            part = tomlin.sweep(scene, over, "driver.mean_force.x", folder=tmp_path / "sweep",
                                threads=1, progress=interrupt)
        except KeyboardInterrupt as error:
            part = error.result
        rows.append((part.status == "finished").sum())
        if part.complete:
            break
    assert part.complete and len(rows) > 1 and rows == sorted(rows)
    with pytest.raises(tomlin.OutputError, match="of a sweep"):
        tomlin.open(tmp_path / "sweep")
    whole = tomlin.sweep(scene, over, "driver.mean_force.x")
    assert (part["driver.mean_force.x"] == whole["driver.mean_force.x"]).all()


def test_progress(tip):
    seen = []
    slow = tip.set({"run.integrator": {"type": "rk4", "dt": 2e-4}})
    slow.run(progress=seen.append)
    assert all(0.0 <= now.time <= now.duration for now in seen)

    def stop(now):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        tip.set(ENDLESS).run(progress=stop)


def test_progress_line(capsys):
    from tomlin._progress import shown

    with shown(True) as show:
        show("10 of 20 points", 10, 20)
        show("done")
    assert "\r10 of 20 points" in capsys.readouterr().err
    with shown(False) as show:
        assert show is None


def test_failed_run_has_the_programs_message(tip, program, tmp_path):
    runaway = tip.set({"force.driver.velocity": [1e3], "run.integrator": {"type": "rk4", "dt": 0.1},
                       "run.allow_unstable": True, "force.viscous_damping.coefficient": 1e-3})
    result = runaway.run()
    assert result.status == "failed"
    with pytest.raises(tomlin.RunError) as raised:
        result.require_finished()
    assert str(raised.value) == result.failure.message and "step" in result.failure.message
    (tmp_path / "scene.toml").write_text(runaway.to_toml())
    done = subprocess.run([program, "run", "scene.toml", "-o", "out"], cwd=tmp_path,
                          capture_output=True, text=True)
    assert done.returncode == 1 and result.failure.cause in done.stderr
    assert tomlin.open(tmp_path / "out").status == "failed"


def test_displays(tip):
    result = tip.run()
    assert "finished" in repr(result) and "mean force" in str(result)
    page = result._repr_html_()
    assert "driver.mean_force" in page and "data:image/png" in page
    assert result.samples._repr_html_() and tip._repr_html_() and tip.simulation()._repr_html_()


def test_plots(tip):
    axes = tip.run().plot()
    assert axes.get_xlabel() == "support position $x$" and axes.get_ylabel() == "force $F_x$"
    assert len(axes.lines[0].get_xdata()) == 801
    other = tip.run().plot("tip.velocity.x", ax=axes)
    assert other is axes and axes.get_xlabel().startswith("time")
    with pytest.raises(KeyError):
        tip.run().plot("no.such.column")
    sweep = tomlin.sweep(tip, {"s": [0.5, 5.0], "v": np.geomspace(0.05, 0.2, 3)},
                         "driver.mean_force.x")
    axes = sweep.plot()
    assert axes.get_xscale() == "log" and len(axes.lines) == 2 and axes.get_legend()
    assert sweep._repr_html_()


def test_without_the_optional_packages():
    """Nothing but figures and tables of others needs them."""
    code = ("import sys\n"
            "for name in ('matplotlib', 'pandas', 'xarray'): sys.modules[name] = None\n"
            "import tomlin\n"
            "result = tomlin.load('scenarios/prandtl_tomlinson/stick_slip.toml').set('v', 0.1).run()\n"
            "assert '<img' not in result._repr_html_()\n"
            "try: result.plot()\n"
            "except ImportError as error: assert 'matplotlib' in str(error)\n"
            "else: raise AssertionError\n")
    subprocess.run([sys.executable, "-c", code], check=True)


def test_sweep_of_others(tip):
    xarray = pytest.importorskip("xarray")
    sweep = tomlin.sweep(tip, {"s": [0.5, 5.0], "v": [0.05, 0.1, 0.2]},
                         ["driver.mean_force.x", "events.slips"])
    data = sweep.to_xarray()
    assert isinstance(data, xarray.Dataset) and data.sizes == {"s": 2, "v": 3}
    assert float(data["driver.mean_force.x"].sel(s=5.0, v=0.1)) == sweep["driver.mean_force.x"][1, 1]
    frame = sweep.to_pandas()
    assert len(frame) == 6 and list(frame["v"][:3]) == [0.05, 0.1, 0.2]
    zipped = tomlin.sweep(tip, {"s": [0.5, 5.0], "v": [0.05, 0.1]}, "driver.mean_force.x",
                          zip=[["s", "v"]])
    assert zipped.shape == (2,) and zipped["driver.mean_force.x"][1] == data[
        "driver.mean_force.x"].sel(s=5.0, v=0.1)
    assert zipped.to_xarray().sizes == {"point": 2} and len(zipped.to_pandas()) == 2
    words = tomlin.sweep(tip, {"run.dynamics": ["inertial", "overdamped"]}, "driver.mean_force.x")
    assert list(words["run.dynamics"]) == ["inertial", "overdamped"]
    assert len(words.to_pandas()) == 2


def test_points_that_are_refused(tip):
    sweep = tomlin.sweep(tip, {"V0": [0.1, -1.0]}, "driver.mean_force.x")
    assert sweep.complete and list(sweep.status) == ["finished", "refused"]
    assert np.isnan(sweep["driver.mean_force.x"][1]) and sweep.reasons[1]
    for over, observables in (({}, "driver.mean_force.x"), ({"v": [0.1]}, []),
                              ({"nothing": [1.0]}, "driver.mean_force.x"),
                              ({"v": []}, "driver.mean_force.x"),
                              ({"v": [0.1]}, "driver.mean_farce.x"),
                              ({"v": "1:2"}, "driver.mean_force.x")):
        with pytest.raises(tomlin.SceneError):
            tomlin.sweep(tip, over, observables)
    with pytest.raises(tomlin.QuantityError):
        sweep["nothing"]


def test_summary_is_plain(tip):
    json.dumps(tip.run().summary)
    assert pickle.loads(pickle.dumps(tip)).to_toml() == tip.to_toml()


def test_threads_share_a_run_of_many_atoms():
    """320 atoms are divided; no number depends on how many threads there are."""
    tube = tomlin.load("scenarios/nanotube/pull.toml").set(
        {"equilibration": 0.01, "run.duration": 0.02, "measure.from": 0.0, "measure.to": 0.02,
         "output.every": 0.005})
    alone = tube.run()
    for threads in (2, 3):
        shared = tube.run(threads=threads)
        assert shared.samples.tobytes() == alone.samples.tobytes()
        assert shared["driver.mean_force.y"] == alone["driver.mean_force.y"]
    with pytest.raises(ValueError, match="1 to 4096"):
        tube.run(threads=0)


def test_files_of_a_result_are_those_of_its_run(tip, tmp_path, monkeypatch):
    """Wherever the process is, and whatever has become of the folder."""
    monkeypatch.chdir(tmp_path)
    tip = tip.set("v", 0.05)
    first = tip.run(folder="a")
    opened = tomlin.open("a")
    monkeypatch.chdir("/")
    for one in (first, opened):
        assert len(one.samples) == len(tip.run().samples) and len(one.events) == one["events.slips"]
    first, opened = tip.run(folder=tmp_path / "b"), tomlin.open(tmp_path / "b")
    tip.set("v", 0.1).run(folder=tmp_path / "b", force=True)
    for one, reads in ((first, ["samples", "events"]), (opened, ["samples", "events", "scene"])):
        for read in reads:
            with pytest.raises(tomlin.OutputError, match="another run"):
                getattr(one, read)
        assert isinstance(one["driver.mean_force.x"], float)
    later = tomlin.open(tmp_path / "b")
    os.remove(tmp_path / "b" / "summary.json")
    with pytest.raises(tomlin.OutputError, match="gone"):
        later.samples
    friction = tomlin.sweep(tip, {"v": [0.05, 0.1]}, "driver.mean_force.x", folder=tmp_path / "c")
    os.remove(tmp_path / "c" / "sweep.json")
    with pytest.raises(tomlin.OutputError):
        friction.summary


@pytest.mark.parametrize("name, change", [
    ("summary.json", lambda text: b"{}"), ("summary.json", lambda text: b"[]"),
    ("events.csv", lambda text: text[:-3]), ("events.csv", lambda text: text + b"a,b,c\n"),
    ("events.csv", lambda text: b"\xff"), ("observables.csv", lambda text: b"\xff\xfe\n"),
    ("observables.csv", lambda text: text[:-5]), ("observables.csv", lambda text: b"")])
def test_damaged_files_of_a_folder(tip, tmp_path, name, change):
    tip.run(folder=tmp_path / "a")
    file = tmp_path / "a" / name
    file.write_bytes(change(file.read_bytes()))
    with pytest.raises(tomlin.OutputError, match=name):
        result = tomlin.open(tmp_path / "a")
        result.events, result.samples


def test_what_is_undefined_is_none_in_folders_as_well(tip, tmp_path):
    def stop(now):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        tip.set(ENDLESS).set("measure.from", 1e8).run(folder=tmp_path / "a", progress=stop)
    opened = tomlin.open(tmp_path / "a")
    assert opened.status == "interrupted"
    for path in ("driver.mean_force.x", "drivers.driver.mean_force.x", "driver.max_force.x"):
        assert opened[path] is None and path in opened
    assert "driver.mean_force.q" not in opened


def test_groups_are_records_however_they_are_read(tip):
    result = tip.run()
    force = result["driver.mean_force.x"]
    assert [one.mean_force.x for one in result["drivers"].values()] == [force]
    assert [one.mean_force.x for _, one in result["drivers"].items()] == [force]
    assert result["drivers"].get("driver").mean_force.x == force
    assert result["drivers"].get("nobody") is None
    samples = pickle.loads(pickle.dumps(result.samples))
    assert samples.units == result.samples.units and (samples == result.samples).all()
