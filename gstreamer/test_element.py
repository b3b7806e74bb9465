"""The element in pipelines of gst-launch-1.0: what it gives is, byte for byte, what the library gives.

PYTHONPATH, GST_PLUGIN_PATH and DIMINISH_RECORDINGS are set by ctest.
"""

import os
import pathlib
import subprocess
import tempfile
import unittest

import diminish

CALENDAR = os.path.join(os.environ["DIMINISH_RECORDINGS"], "calendar")


def launch(*words):
    """gst-launch 1.22 now and then waits for ever after it has said an error, GStreamer's own elements' too (`identity
    error-after=1`: 4 of 160 runs): then it is ended. One that waits without an error fails the test."""
    with tempfile.TemporaryFile("w+") as said:
        program = subprocess.Popen(["gst-launch-1.0", "-q", *words], stderr=said)
        for seconds in (10, 110):
            try:
                program.wait(seconds)
                break
            except subprocess.TimeoutExpired:
                said.seek(0)
                if "ERROR" in said.read():
                    break
        is_stuck = program.poll() is None
        if is_stuck:
            program.kill()
            program.wait()
        said.seek(0)
        done = subprocess.CompletedProcess(program.args, program.returncode, stderr=said.read())
    if is_stuck and "ERROR" not in done.stderr:
        raise TimeoutError(f"{words}: neither a result nor an error")
    return done


class ElementTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pipeline = diminish.Pipeline(CALENDAR, memory="off")
        cls.frames = list(cls.pipeline)
        cls.top = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.top.name)

    @classmethod
    def tearDownClass(cls):
        cls.top.cleanup()

    def source(self, name, arrays, pad, rate=30, image_format="bgr"):
        """The words that bring raw images to a pad."""
        file = self.folder / name
        file.write_bytes(b"".join(array.tobytes() for array in arrays))
        height, width = arrays[0].shape[:2]
        parse = f"rawvideoparse format={image_format} width={width} height={height} framerate={rate}/1"
        return [*f"filesrc location={file} ! {parse} ! {pad}".split()]

    def run_element(self, *sources, more=()):
        out = self.folder / "out.raw"
        out.unlink(missing_ok=True)
        element = ["diminish", "name=d", f"setup={CALENDAR}", "options=memory=off", *more]
        done = launch(*element, "!", "filesink", f"location={out}", *(word for source in sources for word in source))
        return done, out.read_bytes() if out.exists() else b""

    def color(self):
        return self.source("color.raw", [frame.input for frame in self.frames], "d.color")

    def test_gives_the_library_s_bytes(self):
        done, result = self.run_element(
            self.color(),
            self.source("rgbd.raw", [frame.rgbd[0][0] for frame in self.frames], "d.rgbd_color_0"),
            self.source("depth.raw", [frame.rgbd[0][1] for frame in self.frames], "d.rgbd_depth_0", image_format="gray16-le"),
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(len(self.frames), 2)
        self.assertTrue(result == b"".join(frame.picture.tobytes() for frame in self.frames))
        self.assertFalse(result == b"".join(frame.input.tobytes() for frame in self.frames))

    def test_a_slower_camera_is_left_out_where_it_has_nothing(self):
        every_other = self.frames[::2]
        done, result = self.run_element(
            self.color(),
            self.source("rgbd.raw", [frame.rgbd[0][0] for frame in every_other], "d.rgbd_color_0", 15),
            self.source("depth.raw", [frame.rgbd[0][1] for frame in every_other], "d.rgbd_depth_0", 15, "gray16-le"),
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        alone = [self.pipeline.process(frame.input).picture for frame in self.frames]
        self.assertFalse((alone[1] == self.frames[1].picture).all())
        expected = [frame.picture if i % 2 == 0 else alone[i] for i, frame in enumerate(self.frames)]
        self.assertTrue(result == b"".join(picture.tobytes() for picture in expected))

    def test_says_what_is_wrong(self):
        small = [frame.input[:512] for frame in self.frames[:1]]
        for sources, more, text in (
            ([self.color()], ["setup=/nowhere"], "/nowhere"),
            ([self.color()], ["detector=magic"], "magic"),
            ([self.color()], ["options=inpaint=magic"], "inpaint"),
            ([self.source("small.raw", small, "d.color")], [], "1280x1024"),
            ([self.color(), self.source("other.raw", small, "d.rgbd_color_1")], [], "at most"),
        ):
            done, result = self.run_element(*sources, more=more)
            self.assertNotEqual(done.returncode, 0, text)
            self.assertIn(text, done.stderr)
            self.assertEqual(result, b"")


if __name__ == "__main__":
    unittest.main()
