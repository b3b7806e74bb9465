"""Tests of the Python module: python3 test_diminish.py, with PYTHONPATH and DIMINISH_RECORDINGS set."""

import ast
import json
import os
import shutil
import tempfile
import threading
import unittest

import diminish
import numpy as np

RECORDINGS = os.environ["DIMINISH_RECORDINGS"]
CALENDAR = os.path.join(RECORDINGS, "calendar")


def rigid(matrix):
    """Of 3 x 4, with its rotation made one: the file has seven digits."""
    u, _, vt = np.linalg.svd(matrix[:, :3])
    return np.hstack([u @ vt, matrix[:, 3:]])


def trajectory_line(stamp, camera_from_world):
    """"timestamp tx ty tz qx qy qz qw" of the camera in the world, as the TUM benchmark writes it."""
    rotation = camera_from_world[:, :3].T
    translation = -rotation @ camera_from_world[:, 3]
    # The quaternion is an eigenvector (Bar-Itzhack 2000).
    r = rotation
    k = np.array(
        [
            [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0],
            [r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
            [r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1], 0],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], np.trace(r)],
        ]
    )
    quaternion = np.linalg.eigh(k)[1][:, -1]
    return " ".join(repr(float(x)) for x in (stamp, *translation, *quaternion)) + "\n"


class PipelineTest(unittest.TestCase):
    def test_iterates_over_a_recording(self):
        frames = list(diminish.Pipeline(CALENDAR, memory="off"))
        self.assertGreater(len(frames), 1)
        for frame in frames:
            self.assertEqual(frame.picture.shape, (1024, 1280, 3))
            self.assertEqual(frame.picture.dtype, np.uint8)
            self.assertGreater(np.count_nonzero(frame.mask), 10000)
            outside = frame.mask == 0
            self.assertTrue((frame.picture[outside] == frame.input[outside]).all())
            self.assertTrue((frame.provenance[outside] == 0).all())
            self.assertTrue((frame.picture[~outside] != frame.input[~outside]).any())
            report = frame.report
            self.assertEqual(report["mask_pixels"], np.count_nonzero(frame.mask))
            self.assertEqual(report["invented_pixels"], np.count_nonzero(frame.provenance == 254))
            self.assertTrue(report["objects"][0]["in_color"])
            self.assertGreater(report["milliseconds"]["drawing"], 0)

    def test_own_images_give_the_same_bytes(self):
        pipeline = diminish.Pipeline(CALENDAR, memory="off")
        self.assertEqual(pipeline.cameras, ["rgbd0"])
        frame = next(iter(pipeline))
        again = pipeline.process(frame.input, {"rgbd0": frame.rgbd[0]})
        self.assertTrue((again.picture == frame.picture).all())
        mirrored = frame.input[:, ::-1]  # not contiguous
        copied = pipeline.process(np.ascontiguousarray(mirrored), {"rgbd0": frame.rgbd[0]})
        viewed = pipeline.process(mirrored, {"rgbd0": frame.rgbd[0]})
        self.assertTrue((copied.picture == viewed.picture).all())

    def test_a_camera_may_be_missing(self):
        pipeline = diminish.Pipeline(CALENDAR, memory="off")
        frame = next(iter(pipeline))
        alone = pipeline.process(frame.input)
        self.assertEqual(alone.report["seen_pixels"], 0)
        self.assertIn("rgbd0: no images given", " ".join(alone.report["messages"]))

    def test_arrays_outlive_their_frame_and_are_read_only(self):
        picture = next(iter(diminish.Pipeline(CALENDAR, memory="off"))).picture
        self.assertGreater(int(picture.astype(int).sum()), 0)
        with self.assertRaises(ValueError):
            picture[0, 0] = 0

    def test_other_threads_run_meanwhile(self):
        turns = []
        stop = threading.Event()

        def count():
            while not stop.is_set():
                turns.append(1)
                stop.wait(0.001)

        thread = threading.Thread(target=count)
        pipeline = diminish.Pipeline(CALENDAR, memory="off")
        frames = iter(pipeline)
        next(frames)
        thread.start()
        before = len(turns)
        next(frames)
        during = len(turns) - before
        stop.set()
        thread.join()
        self.assertGreater(during, 1)

    def test_detector_and_png(self):
        frame = next(iter(diminish.Pipeline(CALENDAR, detector="difference")))
        self.assertGreater(np.count_nonzero(frame.mask), 10000)
        self.assertEqual(frame._repr_png_()[:8], b"\x89PNG\r\n\x1a\n")

    def test_errors_have_the_programs_text(self):
        with self.assertRaisesRegex(diminish.Error, "/nowhere: expected"):
            diminish.Pipeline("/nowhere")
        with self.assertRaisesRegex(diminish.Error, "inpaint.*magic"):
            diminish.Pipeline(CALENDAR, inpaint="magic")
        with self.assertRaises(AttributeError):
            diminish.Options(no_such_option=1)
        pipeline = diminish.Pipeline(CALENDAR)
        with self.assertRaisesRegex(ValueError, "color: expected height x width x 3, got 4 x 5"):
            pipeline.process(np.zeros((4, 5), np.uint8))
        with self.assertRaisesRegex(diminish.Error, "1280x1024"):
            pipeline.process(np.zeros((4, 5, 3), np.uint8))
        with self.assertRaisesRegex(KeyError, "kinect"):
            frame = next(iter(pipeline))
            pipeline.process(frame.input, {"kinect": frame.rgbd[0]})


class LiveTest(unittest.TestCase):
    def test_ends_with_its_cameras(self):
        live = diminish.Live(CALENDAR, memory="off")
        indices = [frame.index for frame in live]
        self.assertGreater(len(indices), 0)
        self.assertEqual(indices, sorted(set(indices)))
        self.assertEqual([camera["name"] for camera in live.status["cameras"]], ["color", "rgbd0"])

    def test_stops_and_says_what_is_wrong(self):
        replay = "recording:" + CALENDAR + "?loop&rate=0.3"
        live = diminish.Live(CALENDAR, cameras={"color": replay, "rgbd0": "recording:/nowhere"})
        frame = next(live)
        self.assertEqual(frame.picture.shape, (1024, 1280, 3))
        self.assertIn("/nowhere", " ".join(live.status["problems"]))
        live.stop()
        with self.assertRaises(StopIteration):
            while True:
                next(live)
        with self.assertRaisesRegex(ValueError, "cameras: expected color"):
            diminish.Live(CALENDAR, cameras={"kinect": replay})

    def test_a_detector_of_ones_own_runs_in_the_sessions_thread(self):
        @diminish.detector("test_live")
        def everything(color, rgbd):
            return np.full(color.shape[:2], 255, np.uint8)

        frame = next(diminish.Live(CALENDAR, detector="test_live", memory="off"))
        self.assertTrue((frame.mask == 255).all())


class OwnMethodsTest(unittest.TestCase):
    def test_a_detector_and_an_inpainter(self):
        made = []

        @diminish.detector("test_square")
        class Square:
            def __init__(self):
                made.append(self)

            def __call__(self, color, rgbd):
                self.depth = rgbd[0][1]
                mask = np.zeros(color.shape[:2], np.uint8)
                mask[400:500, 600:700] = 255
                in_rgbd = np.zeros(rgbd[0][0].shape[:2], np.uint8)
                in_rgbd[:] = 255  # so that nothing is seen
                return mask, [in_rgbd]

        @diminish.inpainter("test_grey")
        def grey(picture, missing):
            picture[missing > 0] = (10, 20, 30)
            picture[0, 0] = 255  # outside: of no effect
            return picture

        pipeline = diminish.Pipeline(
            CALENDAR, detector="test_square", inpaint="test_grey", memory="off", mask_margin_px=0, soft_rim_px=0
        )
        frame = next(iter(pipeline))
        expected = np.zeros((1024, 1280), np.uint8)
        expected[400:500, 600:700] = 255
        self.assertTrue((frame.mask == expected).all())
        self.assertTrue((frame.picture[400:500, 600:700] == (10, 20, 30)).all())
        self.assertTrue((frame.picture[0, 0] == frame.input[0, 0]).all())
        self.assertEqual(len(made), 1)
        self.assertEqual(made[0].depth.dtype, np.uint16)
        with self.assertRaisesRegex(ValueError, "test_grey.*taken"):
            diminish.inpainter("test_grey")(grey)

    def test_a_pose_source_is_as_good_as_the_program_s_own(self):
        names = ("color_from_world", "rgbd0_depth_from_world")
        with open(os.path.join(CALENDAR, "truth", "poses.json")) as file:
            truth = [{name: rigid(np.array(frame[name])) for name in names} for frame in json.load(file)]
        stamps = []

        @diminish.pose_source("test_truth")
        def from_truth(color, rgbd, stamp_s):
            stamps.append(stamp_s)
            self.assertEqual((color.shape, rgbd[0][1].dtype), ((1024, 1280, 3), np.uint16))
            return truth[len(stamps) - 1]

        frames = list(diminish.Pipeline(CALENDAR, pose_source="test_truth", memory="off"))
        self.assertEqual(stamps, [frame.stamp_s for frame in frames])
        with tempfile.TemporaryDirectory() as top:
            # The same poses as lists, which the program reads.
            copy = shutil.copytree(CALENDAR, os.path.join(top, "calendar"))
            for name, camera in zip(names, ("color", "rgbd0")):
                with open(os.path.join(copy, camera + "_poses.txt"), "w") as file:
                    for stamp, frame in zip(stamps, truth):
                        file.write(trajectory_line(stamp, frame[name]))
            with open(os.path.join(copy, "rig.yaml"), "a") as file:
                file.write("pose: {source: file, files: {color: color_poses.txt, rgbd0: rgbd0_poses.txt}}\n")
            expected = list(diminish.Pipeline(copy, memory="off"))
            # rig.yaml's own source makes way, with its settings.
            stamps.clear()
            again = next(iter(diminish.Pipeline(copy, pose_source="test_truth", memory="off")))
        for ours, theirs in zip([*frames, again], [*expected, expected[0]]):
            difference = np.abs(ours.picture.astype(int) - theirs.picture)
            self.assertGreater(theirs.report["seen_pixels"], 10000)
            self.assertLess(np.count_nonzero(difference), 100)  # by rounding
            self.assertLess(np.count_nonzero(ours.mask != theirs.mask), 10)

    def test_a_pose_source_s_mistakes_are_named(self):
        given = {}

        @diminish.pose_source("test_wrong")
        def wrong(color, rgbd, stamp_s):
            return given or None

        def first():
            return next(iter(diminish.Pipeline(CALENDAR, pose_source="test_wrong", memory="off")))

        self.assertIn("no poses", " ".join(first().report["messages"]))
        given["rgbd9_depth_from_world"] = np.eye(4)
        with self.assertRaisesRegex(ValueError, "NAME_depth_from_world.*got 'rgbd9_depth_from_world'"):
            first()
        del given["rgbd9_depth_from_world"]
        for matrix, text in ((np.eye(3), "expected a matrix of 3 x 4"), (2 * np.eye(4), "expected a rotation")):
            given["color_from_world"] = matrix
            with self.assertRaisesRegex(ValueError, "color_from_world: " + text):
                first()
        with self.assertRaisesRegex(diminish.Error, "nowhere"):
            diminish.Pipeline(CALENDAR, pose_source="nowhere")

    def test_their_errors_are_the_callers(self):
        @diminish.detector("test_broken")
        def broken(color, rgbd):
            raise RuntimeError("no idea")

        @diminish.detector("test_small")
        def small(color, rgbd):
            return np.zeros((2, 3), np.uint8)

        with self.assertRaisesRegex(RuntimeError, "no idea"):
            next(iter(diminish.Pipeline(CALENDAR, detector="test_broken")))
        with self.assertRaisesRegex(ValueError, "expected a mask of 1024 x 1280, got 2 x 3"):
            next(iter(diminish.Pipeline(CALENDAR, detector="test_small")))


class OptionsTest(unittest.TestCase):
    def test_have_the_programs_names_and_ranges(self):
        options = diminish.Options(mask_margin_px=7, memory="off")
        self.assertEqual((options.mask_margin_px, options.memory), (7, "off"))
        self.assertIs(options.refine_poses, True)
        with self.assertRaisesRegex(diminish.Error, "mask_margin_px"):
            diminish.Options(mask_margin_px=-1)
        self.assertIn("structure", diminish.methods("inpaint"))


class PicturesTest(unittest.TestCase):
    def setUp(self):
        y, x = np.mgrid[0:120, 0:160]
        self.plane = np.stack([x + 20, y + 40, (x + y) // 2 + 30], axis=2).astype(np.uint8)
        self.hole = np.zeros((120, 160), np.uint8)
        self.hole[30:80, 40:110] = 255

    def test_inpaint_continues_a_plane(self):
        torn = self.plane.copy()
        torn[self.hole > 0] = 0
        filled = diminish.inpaint(torn, self.hole, 3, 1)
        self.assertLessEqual(int(np.abs(filled.astype(int) - self.plane).max()), 1)
        self.assertTrue((torn[self.hole > 0] == 0).all())

    def test_a_clone_of_itself_with_another_brightness_is_itself(self):
        brighter = np.zeros((150, 170, 3), np.uint8)
        brighter[10:130, 5:165] = self.plane + 15
        mask = np.zeros((150, 170), np.uint8)
        mask[10:130, 5:165] = self.hole
        # The middle of the hole, in dst
        clone = diminish.seamless_clone(brighter, self.plane, mask, (40 + 35, 30 + 25))
        self.assertLessEqual(int(np.abs(clone.astype(int) - self.plane).max()), 1)

    def test_wrong_arrays_are_named(self):
        with self.assertRaisesRegex(ValueError, "inpaintMask: expected height x width, got 3"):
            diminish.inpaint(self.plane, np.zeros(3, np.uint8))
        with self.assertRaises(ValueError):
            diminish.inpaint(self.plane, self.hole[:50])
        with self.assertRaisesRegex(ValueError, "inside dst"):
            diminish.seamless_clone(self.plane, self.plane, self.hole, (5, 5))
        with self.assertRaisesRegex(ValueError, "flags"):
            diminish.seamless_clone(self.plane, self.plane, self.hole, (75, 55), 2)


class StubsTest(unittest.TestCase):
    """diminish.pyi has what the module has."""

    def test_every_name_and_argument(self):
        folder = os.path.dirname(diminish.__file__)
        stubs = [os.path.join(folder, name) for name in ("diminish.pyi", "diminish-stubs/__init__.pyi")]
        with open(next(file for file in stubs if os.path.exists(file))) as file:
            tree = ast.parse(file.read())
        self.compare(diminish, tree.body, ignored={"Picture", "Mask", "Depth", "Transform", "_Method"})

    def compare(self, actual, body, ignored=frozenset()):
        stubbed = {}
        for node in body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                stubbed[node.name] = node
            elif isinstance(node, ast.AnnAssign):
                stubbed[node.target.id] = node
            elif isinstance(node, ast.Assign):
                stubbed[node.targets[0].id] = node
        public = {name for name in vars(actual) if not name.startswith("_")}
        if actual is diminish.Options:
            public = set()  # by __getattr__
        self.assertEqual(public, {name for name in stubbed if not name.startswith("_")} - ignored)
        for name, node in stubbed.items():
            if isinstance(node, ast.ClassDef):
                self.compare(getattr(actual, name), node.body)
            if isinstance(node, ast.FunctionDef) and name != "__getattr__":
                arguments = [argument.arg for argument in node.args.args if argument.arg != "self"]
                signature = getattr(actual, name).__doc__.splitlines()[0]
                for argument in arguments:
                    self.assertRegex(signature, rf"[(, ]{argument}:|\*\*", name)
        self.assertTrue(actual.__doc__)


if __name__ == "__main__":
    unittest.main()
