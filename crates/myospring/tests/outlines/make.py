"""Makes the files of this folder with programs that are not ours.

ROIs by roifile, contours by OpenCV in the way of Cellpose (`utils.outlines_list` and
`io.outlines_to_text`):

    pip install roifile opencv-python-headless numpy
    python make.py
"""

import struct
import zipfile

import cv2
import numpy
from roifile import ROI_OPTIONS, ROI_SUBTYPE, ROI_TYPE, ImagejRoi

FINE = ROI_OPTIONS.SUB_PIXEL_RESOLUTION


def named(roi, name):
    roi.name = name
    return roi


def by_points(points, name, kind=None):
    roi = ImagejRoi.frompoints(numpy.array(points), name=name)
    if kind is not None:
        roi.roitype = kind
    return roi


def by_axis(subtype, x1, y1, x2, y2, parameter):
    """An ellipse or rotated rectangle; ImageJ keeps the parameter as a float in bytes 52 to 56."""
    style, head, arc = struct.unpack(">BBh", struct.pack(">f", parameter))
    roi = by_points([[x1, y1], [x2, y2], [x2, y1]], "", ROI_TYPE.FREEHAND)
    roi.subtype = subtype
    roi.x1, roi.y1, roi.x2, roi.y2 = x1, y1, x2, y2
    roi.arrow_style_or_aspect_ratio, roi.arrow_head_size, roi.rounded_rect_arc_size = style, head, arc
    return roi


polygon = [[10, 20], [50, 20], [50, 30], [20, 40]]
fine = [[10.25, 20.5], [50.75, 20.5], [50.0, 30.125], [20.0, 40.0]]

rois = {
    "polygon": by_points(polygon, "Zelle α", ROI_TYPE.POLYGON),
    "traced": by_points([[2, 2], [5, 2], [5, 5], [9, 5], [9, 9], [5, 9], [5, 5], [2, 5]], "wand", ROI_TYPE.TRACED),
    "freehand": by_points(polygon, "freehand"),
    "fine": by_points(fine, "fine"),
    "rectangle": ImagejRoi(roitype=ROI_TYPE.RECT, left=10, top=20, right=40, bottom=32, name="rectangle"),
    "fine_rectangle": ImagejRoi(
        roitype=ROI_TYPE.RECT, left=10, top=20, right=41, bottom=33, name="fine rectangle", options=FINE,
        xd=10.5, yd=20.25, widthd=30.0, heightd=12.5,
    ),
    "oval": ImagejRoi(roitype=ROI_TYPE.OVAL, left=10, top=20, right=50, bottom=40, name="oval"),
    "ellipse": named(by_axis(ROI_SUBTYPE.ELLIPSE, 10.0, 10.0, 50.0, 40.0, 0.5), "ellipse"),
    "rotated_rectangle": named(by_axis(ROI_SUBTYPE.ROTATED_RECT, 10.0, 10.0, 50.0, 40.0, 12.0), "rotated"),
    "line": ImagejRoi(roitype=ROI_TYPE.LINE, x1=1.0, y1=2.0, x2=30.0, y2=40.0, name="scale bar"),
    "point": by_points([[3, 4], [5, 6]], "beads", ROI_TYPE.POINT),
    "angle": by_points([[3, 4], [5, 6], [9, 9]], "angle", ROI_TYPE.ANGLE),
}

# A square with a hole, and apart from it a shape with one curved side.
path = [0, 10, 10, 1, 40, 10, 1, 40, 40, 1, 10, 40, 4]
path += [0, 20, 20, 1, 20, 30, 1, 30, 30, 1, 30, 20, 4]
path += [0, 50, 10, 1, 60, 10, 3, 70, 20, 70, 30, 60, 40, 2, 55, 45, 50, 40, 4]
rois["composite"] = ImagejRoi(
    roitype=ROI_TYPE.RECT, left=10, top=10, right=70, bottom=45, name="composite",
    shape_roi_size=len(path), multi_coordinates=numpy.array(path, dtype="float32"),
)

for name, roi in rois.items():
    roi.tofile(f"{name}.roi")

with zipfile.ZipFile("RoiSet.zip", "w", zipfile.ZIP_DEFLATED) as file:
    for key in ["polygon", "line", "composite", "oval"]:
        entry = zipfile.ZipInfo(f"0001-{key}.roi", (2020, 1, 1, 0, 0, 0))
        file.writestr(entry, rois[key].tobytes(), zipfile.ZIP_DEFLATED)

labels = numpy.zeros((48, 64), numpy.uint8)
y, x = numpy.mgrid[:48, :64]
labels[((x - 20) / 14.0) ** 2 + ((y - 18) / 9.0) ** 2 < 1] = 1
labels[12:40, 44:56] = 2
labels[40:44, 56:60] = 2  # meets the rest in a corner
labels[20:24, 48:50] = 0  # a hole
labels[34:44, 6:30] = 7
labels[30:34, 10] = 7  # a spur of one pixel
cv2.imwrite("labels.png", labels)

lines = []
for label in numpy.unique(labels)[1:]:
    contours, _ = cv2.findContours(
        (labels == label).astype(numpy.uint8), mode=cv2.RETR_EXTERNAL, method=cv2.CHAIN_APPROX_NONE
    )
    longest = contours[numpy.argmax([len(contour) for contour in contours])]
    lines.append(",".join(map(str, longest.squeeze().flatten())))
with open("cellpose_outlines.txt", "w") as file:
    file.write("\n".join(lines) + "\n")
