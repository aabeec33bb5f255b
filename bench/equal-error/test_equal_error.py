# SPDX-License-Identifier: Apache-2.0
"""Tests of the arithmetic and of the scenes: python3 -m unittest, in this folder."""
import dataclasses
import json
import math
import pathlib
import sys
import tempfile
import unittest
import xml.etree.ElementTree as tree

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "common"))
import ablation  # noqa: E402  (after the path)
import cells  # noqa: E402
import methods  # noqa: E402
import tables  # noqa: E402
from command import Run, View  # noqa: E402
from curves import AT_MOST, MORE_THAN, Bound, cheapest, cost_at, frontier, geometric_mean, ratio  # noqa: E402
from measure import Lab, Plan, render_all  # noqa: E402
from reference import Reference  # noqa: E402

ROOT_LAW = [(float(n), 0.1 / math.sqrt(n)) for n in (1, 4, 16, 64, 256)]  # error as that of Monte Carlo


class Curves(unittest.TestCase):
    def test_a_frontier_keeps_what_nothing_undercuts(self):
        points = [(4.0, 0.3), (1.0, 0.5), (2.0, 0.6), (3.0, 0.4), (3.0, 0.45), (9.0, 0.3)]
        self.assertEqual(frontier(points), [(1.0, 0.5), (3.0, 0.4), (4.0, 0.3)])

    def test_a_power_law_is_interpolated_exactly(self):
        for cost in (1.5, 2.0, 10.0, 100.0, 250.0):
            found = cost_at(ROOT_LAW, 0.1 / math.sqrt(cost))
            self.assertEqual(found.kind, "=")
            self.assertAlmostEqual(found.value / cost, 1)

    def test_measured_points_give_their_own_cost(self):
        for cost, error in ROOT_LAW:
            found = cost_at(ROOT_LAW, error)
            self.assertEqual(found.kind, "=")
            self.assertAlmostEqual(found.value / cost, 1)

    def test_nothing_is_extrapolated(self):
        self.assertEqual(cost_at(ROOT_LAW, 0.2), Bound(1.0, AT_MOST))
        self.assertEqual(cost_at(ROOT_LAW, 0.001), Bound(256.0, MORE_THAN))
        self.assertIsNone(cost_at([], 0.1))

    def test_a_floor_of_bias_is_never_passed(self):
        floor = [(1.0, 0.02), (2.0, 0.012), (4.0, 0.012), (8.0, 0.013)]
        self.assertEqual(cost_at(floor, 0.01), Bound(2.0, MORE_THAN))

    def test_the_cheapest_reaches_the_error_if_any_does(self):
        self.assertEqual(cheapest({"a": Bound(9.0), "b": Bound(2.0, MORE_THAN), "c": None}), ("a", Bound(9.0)))
        self.assertEqual(cheapest({"a": Bound(9.0), "b": Bound(2.0, AT_MOST)}), ("b", Bound(2.0, AT_MOST)))
        self.assertEqual(cheapest({"a": Bound(9.0, MORE_THAN), "b": Bound(2.0, MORE_THAN)}), ("b", Bound(2.0, MORE_THAN)))
        self.assertIsNone(cheapest({"a": None}))

    def test_ratios_keep_what_is_certain(self):
        self.assertEqual(ratio(Bound(6.0), Bound(2.0)), Bound(3.0))
        self.assertEqual(ratio(Bound(6.0, MORE_THAN), Bound(2.0)), Bound(3.0, MORE_THAN))
        self.assertEqual(ratio(Bound(6.0), Bound(2.0, AT_MOST)), Bound(3.0, MORE_THAN))
        self.assertEqual(ratio(Bound(6.0, AT_MOST), Bound(2.0)), Bound(3.0, AT_MOST))
        self.assertIsNone(ratio(Bound(6.0, AT_MOST), Bound(2.0, AT_MOST)))
        self.assertIsNone(ratio(Bound(6.0), Bound(2.0, MORE_THAN)))
        self.assertIsNone(ratio(None, Bound(2.0)))

    def test_geometric_means(self):
        self.assertAlmostEqual(geometric_mean([Bound(2.0), Bound(8.0), None]).value, 4)
        self.assertEqual(geometric_mean([Bound(2.0), Bound(8.0, MORE_THAN)]).kind, MORE_THAN)
        self.assertIsNone(geometric_mean([Bound(2.0, AT_MOST), Bound(8.0, MORE_THAN)]))
        self.assertIsNone(geometric_mean([None]))


def scene_of(gain: float) -> dict:
    """`path` as by the law of Monte Carlo, `cache` the same at 1/gain of the cost; half the rays."""
    runs = {}
    for method, factor in (("path", 1.0), ("cache", 1 / gain)):
        for turn, (cost, error) in enumerate((4.0**i, 0.1 / 2**i) for i in range(6)):
            runs[f"{method}-{turn}-1"] = {
                "method": method, "turn": turn, "seed": 1, "options": f"--method {method}", "rays": 1e6 * cost / 2,
                "cpu_seconds": cost * factor, "wall_seconds": cost * factor,
                "errors": {"l1": error, "rms": 2 * error, "signed": 0.0, "maximum": 1.0, "blocks": error / 10}}
    own = {"l1": 1e-4, "rms": 1e-4, "blocks": 1e-5}
    return {"about": "made up", "runs": runs, "refused": {}, "failed": {}, "done": True,
            "reference": {**own, "passes": 2, "rays_per_pixel": 100, "reached": True, "smallest": {k: 1e-3 for k in own}}}


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        run = {"relumine": "relumine", "cpu": "c", "cores": 2, "load_before": 0.0, "size": [8, 8], "spp": 1, "threads": 1,
               "repeats": 1, "quick": False, "missing": [], "reference_ratio": 3.0}
        self.data = {"run": run, "scenes": {"a": scene_of(4.0), "b": scene_of(9.0), "unfinished": {"runs": {}}}}

    def test_planted_gains_are_found(self):
        a = tables.summed_up(self.data["scenes"]["a"])
        for target in (0.005, 0.01, 0.02):
            self.assertAlmostEqual(tables.gain(a, "cache", None, target).value, 4)
            self.assertAlmostEqual(tables.gain(a, "cache", None, target, "rays").value, 1)
            self.assertAlmostEqual(tables.gain(a, "cache", None, 2 * target, "cpu_seconds", "rms").value, 4)

    def test_settings_are_compared_at_their_own_errors(self):
        a = tables.summed_up(self.data["scenes"]["a"])
        for point in a["points"]["cache"][1:]:
            for error in ("l1", "rms"):
                self.assertAlmostEqual(tables.own_gain(a, point, error).value, 4)
        biased = {**a["points"]["cache"][-1], "l1": 1e-9}
        self.assertEqual(tables.own_gain(a, biased, "l1").kind, MORE_THAN)

    def test_goals_are_judged(self):
        scenes = {name: tables.summed_up(self.data["scenes"][name]) for name in ("a", "b")}
        judged = "\n".join(tables.goals(scenes, [0.005, 0.01, 0.015, 0.02]))
        self.assertIn("- met: `cache` against the best of the path type: geometric mean 6 ", judged)
        slow = "\n".join(tables.goals({**scenes, "c": tables.summed_up(scene_of(2.0))}, [0.01]))
        self.assertIn("**not met**", slow)
        self.assertIn("least 2 (c)", slow)

    def test_repeats_are_summed_up(self):
        scene = scene_of(1.0)
        again = json.loads(json.dumps(scene["runs"]["path-0-1"]))
        again.update(cpu_seconds=3.0, seed=2)
        again["errors"].update(l1=0.3, rms=0.2 * math.sqrt(7))
        scene["runs"]["path-0-2"] = again
        point = tables.summed_up(scene)["points"]["path"][0]
        self.assertAlmostEqual(point["cpu_seconds"], 2)
        self.assertAlmostEqual(point["l1"], 0.2)
        self.assertAlmostEqual(point["rms"], 0.4)

    def test_all_files_are_written(self):
        written = {file.name for file in tables.write_all(self.data, [0.005, 0.01], self.folder)}
        self.assertEqual(written, {"a.svg", "b.svg", "all-l1.svg", "all-rms.svg", "all-blocks.svg", "runs.csv", "ratios.csv",
                                   "report.md"})
        self.assertTrue(tree.parse(self.folder / "a.svg").getroot().tag.endswith("svg"))
        self.assertEqual((self.folder / "runs.csv").read_text().count("\n"), 1 + 2 * 12)


class Plans(unittest.TestCase):
    def test_every_method_has_budgets_and_words(self):
        for quick in (False, True):
            for spp in (1, 16):
                found = methods.budgets(1, spp, quick)
                self.assertEqual(list(found), list(methods.WORDS))
                self.assertTrue(all(found.values()))

    def test_camera_samples_share_the_rays(self):
        rays = [o["gather-rays"] for o in methods.budgets(1, 16, False)["gather"]]
        self.assertEqual(rays, [16, 64, 256])
        self.assertEqual(methods.words({"method": "cache", "unbiased": ""}), "--method cache --unbiased")

    def test_paths_reach_as_far_as_gather_rays_see(self):
        self.assertEqual(cells.Cell("a", "", pathlib.Path("a")).path_depth, 1)
        self.assertEqual(cells.Cell("a", "", pathlib.Path("a"), radiance="direct").path_depth, 2)


class SlowCommand:
    """Every render takes twice the CPU time of the one before, and shows grey."""
    def __init__(self) -> None:
        self.renders = 0

    def render(self, view: View, options: dict, seed: int, threads: int) -> Run:
        self.renders += 1
        stats = {"cpu_seconds": 2.0**self.renders, "total_rays": 1, "rays": {}, "command": "", "stage_seconds": {}}
        return Run(np.ones((8, 8, 3), np.float32), stats, 0.0)


class Budgets(unittest.TestCase):
    def renders(self, stop_at: float, most_seconds: float) -> int:
        command, white = SlowCommand(), Reference([np.full((8, 8, 3), 1.1)] * 2, 2)
        cell = cells.Cell("a", "", pathlib.Path("a.glb"))
        with tempfile.TemporaryDirectory() as folder:
            plan = Plan(8, 8, 1, 1, 1, ["cache"], False, stop_at, most_seconds, 3.0, False)
            lab = Lab(command, None, pathlib.Path("white"), pathlib.Path(folder), plan)
            state = {"runs": {}, "refused": {}, "failed": {}, "start_up_seconds": 0.0}
            render_all(lab, cell, cell.view(8, 8, 1), np.ones((8, 8), bool), white, state, lambda: None)
        return command.renders

    def test_a_method_stops_where_it_is_good_or_dear(self):
        every = len(methods.budgets(1, 1, False)["cache"])
        self.assertEqual(self.renders(0.0, math.inf), every)
        self.assertEqual(self.renders(0.0, 15.0), 4)  # 2, 4, 8, 16 s
        self.assertEqual(self.renders(0.2, math.inf), 1)


class Ablation(unittest.TestCase):
    def test_planted_losses_are_found(self):
        def scene(size: float) -> dict[str, ablation.Outcome]:
            whole = ablation.Outcome(2.0 * size, 1e6, 0.01 * size, 0.02, 0.001)
            found = {variant: whole for variant in ablation.VARIANTS}
            found["no residual rays"] = dataclasses.replace(whole, seconds=whole.seconds / 2, l1=whole.l1 * size)
            return found

        scenes = [scene(2.0), scene(8.0)]
        self.assertAlmostEqual(ablation.mean_ratio(scenes, "no residual rays", "l1"), 4)
        rows = ablation.table_of_means(scenes)
        self.assertIn(f"| {ablation.WHOLE} | 1.00 | 1.00 | 1.00 | 1.00 |", rows)
        self.assertIn("| no residual rays | 0.50 | 4.00 | 1.00 | 1.00 |", rows)
        self.assertIn("| no residual rays | 4.00 %, 2 s | 64.00 %, 8 s |", ablation.table_of_all(["a", "b"], scenes))
        self.assertIn("| no residual rays | 2 | 1 | 4.00 % | 2.00 % | 0.10 % |", ablation.table_of_scene("a", 0.001, scenes[0]))

    def test_only_the_whole_has_no_options_of_its_own(self):
        self.assertEqual([v for v, options in ablation.VARIANTS.items() if not options], [ablation.WHOLE])
        self.assertEqual(ablation.options_of("`block-gather`", "0.01"), {"method": "block-gather", "error": "0.01"})
        self.assertEqual(ablation.options_of(ablation.WHOLE, "0.01")["method"], "cache")


class Scenes(unittest.TestCase):
    def test_our_own_scenes_are_written_and_the_same_every_time(self):
        for write in (cells.write_still_life, cells.write_window, cells.write_room, cells.write_blinds, cells.write_foliage,
                      cells.write_gloss):
            with tempfile.TemporaryDirectory() as folder:
                once, again = (pathlib.Path(folder) / name for name in ("a.glb", "b.glb"))
                write(once)
                write(again)
                self.assertEqual(once.read_bytes()[:4], b"glTF")
                self.assertEqual(once.read_bytes(), again.read_bytes())


if __name__ == "__main__":
    unittest.main()
