"""The drawing of camera placements in the docs: it is what its script draws, and its figures hold against a formula."""

import importlib.machinery
import importlib.util
import math
import pathlib
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent.parent / "scripts/draw-placements"


def load():
    loader = importlib.machinery.SourceFileLoader("draw_placements", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("draw_placements", loader))
    loader.exec_module(module)
    return module


class PlacementsTest(unittest.TestCase):
    def setUp(self):
        self.script = load()

    def test_the_drawing_is_up_to_date(self):
        self.assertEqual(self.script.OUT.read_text(), self.script.drawing())

    def test_beside_the_user_the_object_s_shadow_on_the_wall_is_unseen(self):
        # Lines from a camera at (x, 0) past the object's right side, at 0.8 and at 0.95 m, to the wall at 2 m.
        for x in (0.3, 0.38, 0.5, 0.6):
            unseen_to = max(x + (0.2 - x) * 2 / depth for depth in (0.8, 0.95))
            hidden_to = 0.2 * 2 / 0.8
            seen = math.atan(hidden_to / 2) - math.atan(unseen_to / 2)
            columns = self.script.evaluate([], [((x, 0.0), self.script.BEHIND)])
            self.assertAlmostEqual(self.script.coverage(columns), seen / (2 * math.atan(hidden_to / 2)), delta=0.005)

    def test_pixels_are_as_wide_as_their_angle_distance_and_slant_make_them(self):
        columns = self.script.evaluate([], [((0.6, 0.0), self.script.BEHIND)])
        for (x, y), best in columns[:: len(columns) // 7]:
            if best is None:
                continue
            user, camera = math.hypot(x, y), math.hypot(x - 0.6, y)
            # Both look at the same wall: width = distance * pixel / cos, and cos = 2 / distance.
            self.assertAlmostEqual(best, 2 * (camera / user) ** 2, delta=1e-3)


if __name__ == "__main__":
    unittest.main()
