"""diminish beside OpenCV, on this machine: python3 benchmark.py RECORDING

Clones and fills the objects of a recording's frames. Prints the medians and their ratio."""

import statistics
import sys
import time

import cv2
import diminish
import numpy as np


def milliseconds(work, times=5):
    taken = []
    for _ in range(times):
        begin = time.perf_counter()
        work()
        taken.append(1000 * (time.perf_counter() - begin))
    return statistics.median(taken)


def compare(name, ours, peers):
    a, b = milliseconds(ours), milliseconds(peers)
    print(f"{name:<16} {a:8.2f} ms   OpenCV {b:8.1f} ms   {b / a:5.1f} times as fast")


frame = next(iter(diminish.Pipeline(sys.argv[1], memory="off")))
mask = frame.mask.copy()
mask[[0, -1], :] = 0
mask[:, [0, -1]] = 0
height, width = mask.shape
ys, xs = np.nonzero(mask)
middle = ((int(xs.min()) + int(xs.max()) + 1) // 2, (int(ys.min()) + int(ys.max()) + 1) // 2)
source, target = frame.picture, frame.input
print(f"{width} x {height}, {len(xs)} pixels masked")
compare(
    "seamless_clone",
    lambda: diminish.seamless_clone(source, target, mask, middle),
    lambda: cv2.seamlessClone(source, target, mask, middle, cv2.NORMAL_CLONE),
)
compare(
    "inpaint",
    lambda: diminish.inpaint(target, mask),
    lambda: cv2.inpaint(target, mask, 5, cv2.INPAINT_TELEA),
)
