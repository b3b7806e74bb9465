"""Tests of the Python module: python3 test_diminish.py, with PYTHONPATH and DIMINISH_RECORDINGS set."""

import os
import threading
import unittest

import diminish
import numpy as np

RECORDINGS = os.environ["DIMINISH_RECORDINGS"]
CALENDAR = os.path.join(RECORDINGS, "calendar")


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


if __name__ == "__main__":
    unittest.main()
