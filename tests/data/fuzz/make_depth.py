#!/usr/bin/env python3
"""Writes the images of depth/ with NumPy and OpenCV: 8 x 6 pixels, 1 m + 1 cm per pixel, with NaN,
infinity, -1 and 0 in the first four (0 in files of integers, which are in millimetres)."""

import os

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
import cv2
import numpy as np

os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "depth"))

metres = (1 + 0.01 * np.arange(48)).reshape(6, 8).astype("<f4")
metres[0, :4] = np.nan, np.inf, -1, 0
millimetres = np.round(1000 * np.nan_to_num(metres, posinf=0)).clip(0).astype("<u2")

for kind in ("<f2", "<f4", "<f8"):
    np.save(f"seed_{kind[1:]}.npy", metres.astype(kind))
np.save("seed_u2.npy", millimetres)
np.save("seed_hw1.npy", metres[:, :, None])
cv2.imwrite("seed_f4.tiff", metres)
cv2.imwrite("seed_u2.tiff", millimetres)
cv2.imwrite("seed_plain.tif", metres, [cv2.IMWRITE_TIFF_COMPRESSION, 1])
cv2.imwrite("seed_deflate.tiff", millimetres, [cv2.IMWRITE_TIFF_COMPRESSION, 8])
cv2.imwrite("seed_f4.exr", metres)
cv2.imwrite("seed_half.exr", metres, [cv2.IMWRITE_EXR_TYPE, cv2.IMWRITE_EXR_TYPE_HALF])

# Not read as depth.
np.save("bad_fortran.npy", np.asfortranarray(metres))
np.save("bad_big_endian.npy", metres.astype(">f4"))
np.save("bad_int32.npy", millimetres.astype("<i4"))
np.save("bad_objects.npy", np.array([[{"a": 1}]], dtype=object), allow_pickle=True)
np.save("bad_fields.npy", np.zeros((6, 8), dtype=[("z", "<f4")]))
np.save("bad_rgb.npy", np.zeros((6, 8, 3), "<f4"))
np.save("bad_row.npy", np.zeros(48, "<f4"))
cv2.imwrite("bad_8_bit.tiff", np.zeros((6, 8), "u1"))
cv2.imwrite("bad_color.tiff", np.zeros((6, 8, 3), "<u2"))
cv2.imwrite("bad_color.exr", np.zeros((6, 8, 3), "<f4"))
