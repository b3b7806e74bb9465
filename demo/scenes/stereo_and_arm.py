#!/usr/bin/python3
"""The cameras and motions of the recordings stereo and arm, for a renderer to make them anew.

World frame: the world marker's; x right, y up, z out of the wall; metres. t: seconds. A camera is (eye, target, roll):
it looks from one to the other, its x axis is level. Compares itself with the bundled recordings' truth:
    demo/scenes/stereo_and_arm.py
"""
import json
import math
import pathlib

import numpy as np

STEREO_FPS, ARM_FPS = 30, 10

# The RGB-D camera's colour sensor in its depth sensor's frame
COLOR_IN_DEPTH_TURN, COLOR_IN_DEPTH_M = [0.004, -0.006, 0.002], [-0.0520, 0.0005, 0.0010]

# The arm: link, parent, joint in the parent's frame, axis. Meshes: demo/recordings/arm/arm/LINK.obj
ARM_IN_WORLD_M = [0.36, -0.45, 0.50]
ARM_LINKS = [
    ("base", None, [0, 0, 0], None),
    ("turret", "base", [0, 0.06, 0], "y"),
    ("upper", "turret", [0, 0.07, 0], "z"),
    ("fore", "upper", [0, 0.22, 0], "z"),
    ("wrist", "fore", [0, 0.18, 0], "z"),
    ("hand", "wrist", [0, 0.055, 0], "y"),
]


def held(t, eye, reach, start):
    """A hand-held camera's place around `eye`."""
    return [
        eye[0] + reach * math.sin(2 * math.pi * 0.9 * t + start),
        eye[1] + reach * math.sin(2 * math.pi * 0.7 * t + 1.3 * start + 0.5),
        eye[2] + reach * math.sin(2 * math.pi * 0.5 * t + 2.1 * start + 1),
    ]


def stereo(t):
    """Calendar with two colour cameras: left is where its RGB-D camera is, right 25 cm beside, along its depth sensor's x
    axis. What they see looks as in calendar."""
    return {
        "color": (held(t, [0.18, 0.04, 1.52], 0.02, 0.3), [0.22, -0.10, 0.0], 0.02 * math.sin(3 * t)),
        "left": (held(t, [-0.32, 0.50, 0.70], 0.006, 1.7), [0.36, -0.22, 0.10], 0),  # its depth sensor
        "right_in_left_m": [0.25, 0, 0],
    }


def arm(t):
    """Three RGB-D cameras (their depth sensors) around an arm."""
    return {
        "color": (held(t, [0.20, 0.05, 1.45], 0.02, 1.0), [0.24, -0.12, 0.0], 0),
        "rgbd0": (held(t, [-0.40, 0.34, 0.80], 0.003, 1.0), [0.25, -0.16, 0.05], 0),
        "rgbd1": (held(t, [0.95, 0.40, 0.88], 0.003, 2.0), [0.22, -0.17, 0.05], 0),
        "rgbd2": (held(t, [0.22, 0.78, 0.62], 0.003, 3.0), [0.26, -0.22, 0.06], 0),
        "angles": [
            0.5 * math.sin(1.6 * t),
            0.35 + 0.25 * math.sin(1.9 * t + 0.4),
            -1.15 + 0.30 * math.sin(2.3 * t),
            -0.70 + 0.30 * math.sin(2.9 * t + 1.0),
            1.2 * t,
        ],
    }


def turn(vector):
    """The rotation about a vector by its length, radians."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle if angle > 0 else (0, 0, 0)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


def transform(rotation, translation):
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = rotation, translation
    return result


def world_from_camera(camera):
    """camera: x right, y down, z forward."""
    eye, target, roll = camera
    forward = np.subtract(target, eye)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    level = np.stack([right, np.cross(forward, right), forward], axis=1)
    return transform(level @ turn([0, 0, roll]), eye)


def world_from_links(angles):
    """By link, where its mesh stands."""
    axes, places, joints = {"y": [0, 1, 0], "z": [0, 0, 1]}, {}, iter(angles)
    for name, parent, origin, axis in ARM_LINKS:
        start = places[parent] if parent else transform(np.eye(3), ARM_IN_WORLD_M)
        rotation = turn(np.multiply(axes[axis], next(joints))) if axis else np.eye(3)
        places[name] = start @ transform(rotation, origin)
    return places


def check():
    recordings = pathlib.Path(__file__).resolve().parent.parent / "recordings"
    color_in_depth = transform(turn(COLOR_IN_DEPTH_TURN), COLOR_IN_DEPTH_M)
    worst = 0

    def compare(world_from_sensor, truth):
        nonlocal worst
        worst = max(worst, np.abs(np.linalg.inv(world_from_sensor)[:3] - np.array(truth)).max())

    for index, truth in enumerate(json.loads((recordings / "stereo/truth/poses.json").read_text())):
        scene = stereo(index / STEREO_FPS)
        compare(world_from_camera(scene["color"]), truth["color_from_world"])
        left = world_from_camera(scene["left"])
        right = left @ transform(np.eye(3), scene["right_in_left_m"])
        for name, place in ("left", left), ("right", right):
            key = next(key for key in truth if key.startswith(name))
            compare(place @ color_in_depth, truth[key])
    for index, truth in enumerate(json.loads((recordings / "arm/truth/poses.json").read_text())):
        scene = arm(index / ARM_FPS)
        compare(world_from_camera(scene["color"]), truth["color_from_world"])
        for name in ("rgbd0", "rgbd1", "rgbd2"):
            compare(world_from_camera(scene[name]), truth[name + "_depth_from_world"])
    print(f"poses: within {worst:.1e} of the truth")
    rows = [line.split() for line in (recordings / "arm/angles.txt").read_text().splitlines() if line[0] != "#"]
    first = float(rows[0][0])
    off = max(abs(float(a) - b) for row in rows for a, b in zip(row[1:], arm(float(row[0]) - first)["angles"]))
    print(f"joints: within {off:.1e} radians")


if __name__ == "__main__":
    check()
