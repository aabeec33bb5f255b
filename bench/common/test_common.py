# SPDX-License-Identifier: Apache-2.0
"""Tests of the parts in Python: python3 -m unittest, in this folder."""
import pathlib
import struct
import tempfile
import unittest
import zlib

import numpy as np

import environments
import meshes
import metrics
import pictures
import plots
from command import Run, View, looked_up, stacked


def cube() -> meshes.Mesh:
    positions = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return positions, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def torus(columns: int = 8, rows: int = 6) -> meshes.Mesh:
    index = np.arange(rows * columns).reshape(rows, columns)
    right, up = np.roll(index, -1, axis=1), np.roll(index, -1, axis=0)
    both = np.roll(right, -1, axis=0)
    triangles = np.concatenate([np.stack([index, right, both], axis=2), np.stack([index, both, up], axis=2)])
    u, v = 2 * np.pi * (index % columns) / columns, 2 * np.pi * (index // columns) / rows
    ring = 2 + np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], axis=2).reshape(-1, 3), triangles.reshape(-1, 3)


class LoopSubdivision(unittest.TestCase):
    def test_keeps_closedness_and_genus_and_quadruples_the_triangles(self):
        for mesh, characteristic in ((cube(), 2), (meshes.icosahedron(), 2), (torus(), 0)):
            for steps in (1, 2):
                finer = meshes.loop_subdivision(mesh, steps)
                self.assertEqual(len(finer[1]), 4**steps * len(mesh[1]))
                self.assertTrue(meshes.is_closed(finer))
                self.assertEqual(meshes.euler_characteristic(finer), characteristic)

    def test_keeps_the_orientation(self):
        for mesh in (cube(), meshes.icosahedron()):
            self.assertGreater(meshes.signed_volume(mesh), 0)
            self.assertGreater(meshes.signed_volume(meshes.loop_subdivision(mesh, 2)), 0)

    def test_a_cube_becomes_round(self):
        finer = meshes.loop_subdivision(cube(), 4)
        radius = np.linalg.norm(finer[0], axis=1)
        self.assertLess(radius.max() / radius.min(), 1.35)  # of the cube itself: 1.73
        normals = meshes.smooth_normals(finer)
        outward = (normals * finer[0]).sum(axis=1) / radius
        self.assertGreater(outward.min(), 0.9)

    def test_an_icosahedron_becomes_nearly_a_sphere(self):
        radius = np.linalg.norm(meshes.loop_subdivision(meshes.icosahedron(), 4)[0], axis=1)
        self.assertLess(radius.max() / radius.min(), 1.06)

    def test_commutes_with_affine_maps(self):
        matrix, offset = np.array([[1, 2, 0], [0, 1, 3], [1, 0, 2.0]]), np.array([5.0, -1, 2])
        moved = meshes.loop_subdivision((torus()[0] @ matrix.T + offset, torus()[1]))
        np.testing.assert_allclose(moved[0], meshes.loop_subdivision(torus())[0] @ matrix.T + offset, atol=1e-12)

    def test_a_regular_vertex_gets_the_box_splines_weights(self):
        positions = np.zeros((48, 3))
        positions[20] = 1  # of the torus, where every vertex has six neighbours
        finer = meshes.loop_subdivision((positions, torus()[1]))[0][:, 0]
        self.assertAlmostEqual(finer[20], 10 / 16)
        values, counts = np.unique(np.round(finer[:48] * 16, 9), return_counts=True)
        self.assertEqual(dict(zip(values, counts)), {0: 41, 1: 6, 10: 1})
        values, counts = np.unique(np.round(finer[48:] * 8, 9), return_counts=True)
        self.assertEqual(dict(zip(values, counts)), {0: 144 - 12, 1: 6, 3: 6})

    def test_open_meshes_are_refused(self):
        with self.assertRaises(ValueError):
            meshes.loop_subdivision((cube()[0], cube()[1][1:]))

    def test_the_stand_in_is_closed_and_large_enough(self):
        shape = meshes.knobbed_shape()
        self.assertGreaterEqual(len(shape[1]), 300_000)
        self.assertTrue(meshes.is_closed(shape))
        self.assertEqual(meshes.euler_characteristic(shape), 2)
        self.assertGreater(meshes.signed_volume(shape), 0)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_pfm_comes_back_as_written(self):
        picture = np.random.default_rng(1).random((5, 7, 3)).astype(np.float32)
        pictures.write_pfm(self.folder / "a.pfm", picture)
        np.testing.assert_array_equal(pictures.read_pfm(self.folder / "a.pfm"), picture)

    def test_pfm_rows_run_upwards_in_either_byte_order(self):
        for scale, order in (("-1.0", "<"), ("1.0", ">")):
            (self.folder / "b.pfm").write_bytes(f"Pf\n1 2\n{scale}\n".encode() + struct.pack(order + "2f", 3, 4))
            np.testing.assert_array_equal(pictures.read_pfm(self.folder / "b.pfm")[:, 0, 0], [4, 3])

    def test_short_pfm_is_refused(self):
        (self.folder / "c.pfm").write_bytes(b"PF\n2 2\n-1.0\n" + bytes(40))
        with self.assertRaises(ValueError):
            pictures.read_pfm(self.folder / "c.pfm")

    def test_png_holds_the_pixels(self):
        pixels = np.random.default_rng(2).integers(0, 256, (3, 4, 3), dtype=np.uint8)
        pictures.write_png(self.folder / "d.png", pixels)
        data, chunks, at = (self.folder / "d.png").read_bytes(), {}, 8
        while at < len(data):
            length, kind = struct.unpack(">I4s", data[at:at + 8])
            body = data[at + 8:at + 8 + length]
            self.assertEqual(struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0], zlib.crc32(kind + body))
            chunks[kind], at = body, at + 12 + length
        self.assertEqual(struct.unpack(">IIBBBBB", chunks[b"IHDR"]), (4, 3, 8, 2, 0, 0, 0))
        rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(3, 13)
        self.assertFalse(rows[:, 0].any())
        np.testing.assert_array_equal(rows[:, 1:].reshape(3, 4, 3), pixels)

    def test_obj_and_ply(self):
        (self.folder / "a.obj").write_text("# x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1/1 2/2 3/3\nf -4 -3 -1\n")
        positions, triangles = meshes.read_obj(self.folder / "a.obj")
        np.testing.assert_array_equal(triangles, [[0, 1, 2], [0, 1, 3]])
        (self.folder / "a.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "property float q\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2\n")
        found = meshes.read_ply(self.folder / "a.ply")
        np.testing.assert_array_equal(found[0], positions[:3])
        np.testing.assert_array_equal(found[1], [[0, 1, 2]])


class Metrics(unittest.TestCase):
    def test_errors_of_known_pictures(self):
        reference = np.full((2, 2, 3), 2.0)
        picture = reference.copy()
        picture[0, 0] += 0.8
        picture[0, 1] -= 0.4
        picture[1, 1] = 99
        keep = np.array([[True, True], [True, False]])
        e = metrics.errors(picture, reference, keep)
        self.assertAlmostEqual(e.l1, 1.2 / 6)
        self.assertAlmostEqual(e.signed, 0.4 / 6)
        self.assertAlmostEqual(e.rms, np.sqrt(0.8 / 3) / 2)
        self.assertAlmostEqual(e.maximum, 0.4)

    def test_block_errors_see_bias_but_not_noise_within_a_block(self):
        reference, keep = np.full((40, 24, 3), 2.0), np.ones((40, 24), bool)
        sign = np.where(np.indices((40, 24)).sum(axis=0) % 2, 1.0, -1.0)[:, :, None]
        self.assertAlmostEqual(metrics.block_error(reference + 0.5 * sign, reference, keep), 0)
        self.assertAlmostEqual(metrics.block_error(reference - 0.1, reference, keep), 0.05)
        half = reference.copy()
        half[:16] += 0.1
        half[16:] -= 0.1
        self.assertAlmostEqual(metrics.block_error(half, reference, keep), 0.05)
        keep[:, 12:] = False
        half[:, 12:] = 99
        self.assertAlmostEqual(metrics.block_error(half, reference, keep), 0.05)

    def test_the_error_of_a_mean_is_estimated_from_its_halves(self):
        generator = np.random.default_rng(3)
        truth, keep = np.full((200, 200, 3), 5.0), np.ones((200, 200), bool)
        a, b = (truth + generator.normal(0, 0.3, truth.shape) for _ in range(2))
        estimate, true = metrics.error_of_mean(a, b, keep), metrics.errors((a + b) / 2, truth, keep)
        self.assertAlmostEqual(estimate.l1 / true.l1, 1, delta=0.02)
        self.assertAlmostEqual(estimate.rms / true.rms, 1, delta=0.02)

    def test_speed_ups_are_those_of_the_papers_tables(self):
        self.assertAlmostEqual(metrics.raw_speed_up(950.9, 44.0), 21.6, delta=0.05)
        self.assertAlmostEqual(metrics.squared_error_ratio(4.7, 1.9), 6.12, delta=0.01)
        self.assertAlmostEqual(metrics.equal_error_speed_up(950.9, 44.0, 4.7, 3.4), 41, delta=0.5)
        self.assertAlmostEqual(metrics.equal_error_speed_up(950.9, 961.4, 4.7, 1.9), 6.05, delta=0.01)

    def test_averages(self):
        mean = metrics.average([metrics.Errors(1, 3, -1, 2), metrics.Errors(3, 4, 1, 4)])
        self.assertEqual((mean.l1, mean.signed, mean.maximum), (2, 0, 3))
        self.assertAlmostEqual(mean.rms, np.sqrt(12.5))

    def test_spread_is_that_of_a_sample(self):
        spread = metrics.spread([metrics.Errors(1, 3, -1, 2), metrics.Errors(3, 4, 1, 4)])
        self.assertAlmostEqual(spread.l1, np.sqrt(2))
        self.assertAlmostEqual(spread.signed, np.sqrt(2))
        self.assertIsNone(metrics.spread([metrics.Errors(1, 3, -1, 2)]))

    def test_control_takes_whole_packets(self):
        self.assertEqual(metrics.control_rays(10, 80, 4096), 512)
        self.assertEqual(metrics.control_rays(0.001, 80, 4096), 16)

    def test_statistics_are_looked_up_by_dotted_names(self):
        stats = {"cache": {"records": 7, "cpu_seconds": {"shade": 0.5}}}
        self.assertEqual(looked_up(stats, "cache.records"), 7)
        self.assertEqual(looked_up(stats, "cache.cpu_seconds.shade"), 0.5)
        self.assertIsNone(looked_up(stats, "cache.points"))
        self.assertIsNone(looked_up(stats, "cache.records.x"))


class Looks(unittest.TestCase):
    def test_signed_errors_are_red_above_and_blue_below(self):
        reference = np.ones((1, 3, 3))
        picture = reference + np.array([0.1, 0.0, -0.1])[None, :, None]
        colours = pictures.signed_error(picture, reference, np.ones((1, 3), bool), full_scale=0.1)
        np.testing.assert_array_equal(colours[0], [[255, 0, 0], [255, 255, 255], [0, 0, 255]])

    def test_sheet_has_room_for_all(self):
        cell = np.zeros((10, 20, 3), np.uint8)
        page = pictures.sheet([[("a", cell), ("b", cell)], [("c", cell)]])
        self.assertEqual(page.shape, (2 * (10 + pictures.CAPTION_HEIGHT + 4) + 4, 2 * 24 + 4, 3))

    def test_environments_are_positive_and_the_sun_stands_where_it_should(self):
        d = environments.directions(512, 256)
        np.testing.assert_allclose(np.linalg.norm(d, axis=2), 1)
        self.assertGreater(d[0, 0, 1], 0.99)  # the first row is +Y
        sky, sun = environments.smooth_sky(d), environments.sun(d)
        self.assertGreater(sky.min(), 0.05)
        self.assertGreater(d.reshape(-1, 3)[sun[..., 0].argmax()] @ environments.towards_sun(), np.cos(np.radians(1)))

    def test_plots_are_well_formed(self):
        import xml.etree.ElementTree as tree
        text = plots.chart([plots.Panel("error < 1 %", "n", "L1", {"a & b": [(16, 0.1), (32, 0.05)]})])
        self.assertTrue(tree.fromstring(text).tag.endswith("svg"))

    def test_panels_stand_in_rows_and_ten_lines_differ_in_colour(self):
        panel = plots.Panel("", "x", "y", {str(i): [(1, 1 + i), (2, 1 + i)] for i in range(10)})
        text = plots.chart([panel] * 5, columns=3)
        self.assertIn(f'width="{3 * plots.WIDTH}"', text)
        self.assertIn(f'translate({plots.WIDTH} {plots.HEIGHT})', text)
        self.assertEqual(len(set(plots.COLOURS[:10])), 10)
        self.assertTrue(all(text.count(f'stroke="{colour}" stroke-width') == 6 for colour in plots.COLOURS[:10]))

    def test_many_values_along_x_get_round_numbers(self):
        line = [(1.1 + 0.37 * i, 1.0) for i in range(30)]
        text = plots.chart([plots.Panel("", "x", "y", {"a": line})])
        self.assertIn(">10</text>", text)
        self.assertNotIn(">1.47</text>", text)


class Views(unittest.TestCase):
    def test_options_of_a_view(self):
        lit = View(pathlib.Path("a.glb"), pathlib.Path("sky.pfm"), 30.0, 64, 32)
        self.assertEqual(lit.options(), {"environment": "sky.pfm", "env-rotate": 30.0, "size": "64x32"})
        own = View(pathlib.Path("a.glb"), None, 0.0, 64, 32, {"radiance": "direct"})
        self.assertEqual(own.options(), {"size": "64x32", "radiance": "direct"})

    def test_rows_of_a_view(self):
        whole = View(pathlib.Path("a.glb"), None, 0.0, 64, 6)
        self.assertEqual(whole.rows(), [0, 1, 2, 3, 4, 5])
        banded = View(pathlib.Path("a.glb"), None, 0.0, 64, 6, bands=((1, 3), (5, 6)))
        self.assertEqual(banded.rows(), [1, 2, 5])
        self.assertEqual(banded.whole(), whole)

    def test_bands_as_one_run(self):
        def band(rows, seconds, value, **more):
            return Run(np.full((rows, 4, 3), value), {"cpu_seconds": seconds, "peak_memory_bytes": 7 + rows, "version": "1",
                                                      "stopped": False, "rays": {"gather": 10 * rows}, **more}, seconds)
        run = stacked([band(1, 2.0, 0.0), band(2, 3.0, 1.0, cache={"points": 5})], 4.0)
        self.assertEqual(run.picture[:, 0, 0].tolist(), [0, 1, 1])
        self.assertEqual(run.stats, {"cpu_seconds": 20, "peak_memory_bytes": 9, "version": "1", "stopped": False,
                                     "rays": {"gather": 120}, "cache": {"points": 20}})
        self.assertEqual(run.process_cpu, 20)


if __name__ == "__main__":
    unittest.main()
