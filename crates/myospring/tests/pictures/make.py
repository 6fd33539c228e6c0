"""Makes the files of this folder; needs numpy, tifffile, imagecodecs and Pillow.

Each pixel of a plane holds 16 * row + column + 1000 * channel + 100 * slice + 10 * frame, as far as
the type of its numbers goes; the test computes the same.
"""

import numpy as np
import tifffile
from PIL import Image

HEIGHT, WIDTH = 6, 9
MICRO = "\u00b5m"


def plane(channel=0, slice_=0, frame=0):
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    return 16 * rows + columns + 1000 * channel + 100 * slice_ + 10 * frame


def stack(frames, slices, channels):
    return np.array(
        [[[plane(c, z, t) for c in range(channels)] for z in range(slices)] for t in range(frames)]
    )


def write(name, data, **options):
    tifffile.imwrite(name, data, **options)


size = {"PhysicalSizeX": 0.27, "PhysicalSizeY": 0.27}
units = {"PhysicalSizeXUnit": MICRO, "PhysicalSizeYUnit": MICRO}
data = stack(2, 3, 2).astype("uint16")
write("ome_tzcyx.ome.tif", data, ome=True, metadata={"axes": "TZCYX", **size, **units})
# The same planes, with channels slowest in the file.
write(
    "ome_ctzyx.ome.tif",
    data.transpose(2, 0, 1, 3, 4),
    ome=True,
    metadata={"axes": "CTZYX", "PhysicalSizeX": 270, "PhysicalSizeXUnit": "nm",
              "PhysicalSizeY": 270, "PhysicalSizeYUnit": "nm"},
)
write("ome_big.ome.tif", data, ome=True, bigtiff=True, byteorder=">",
      metadata={"axes": "TZCYX", **size, **units})
rgb = np.stack([plane(), plane() + 50, plane() + 100], axis=-1).astype("uint8")
write("ome_rgb.ome.tif", rgb, ome=True, photometric="rgb", metadata={"axes": "YXS", **size})
write(
    "ome_rectangular.ome.tif",
    plane().astype("uint8"),
    ome=True,
    metadata={"PhysicalSizeX": 0.27, "PhysicalSizeY": 0.5, **units},
)

write("imagej_tzcyx.tif", data, imagej=True, resolution=(1 / 0.27, 1 / 0.27),
      metadata={"axes": "TZCYX", "unit": "um"})
# What ImageJ writes for any series of pages, here a film: `slices` and no `hyperstack`.
with tifffile.TiffWriter("imagej_series.tif") as file:
    for frame in range(3):
        file.write(
            plane(frame=frame).astype("uint8"),
            description="ImageJ=1.52p\nimages=3\nslices=3\nunit=micron\n",
            resolution=(4, 4),
            resolutionunit=1,
            metadata=None,
            software=False,
        )

for compression in ["lzw", "deflate", "packbits"]:
    # tifffile compresses without predictor unless asked.
    write(f"tiles_{compression}.tif", plane().repeat(4, 0).repeat(4, 1).astype("uint16"),
          tile=(16, 16), compression=compression, predictor=compression != "packbits",
          byteorder=">" if compression == "lzw" else "<", metadata=None)
write("float_predictor.tif", (plane() / 8).astype("float32"), compression="deflate", predictor=3,
      tile=(16, 16), metadata=None)
planar = np.stack([plane(), plane(1), plane(2)]).astype("uint16").repeat(4, 1).repeat(4, 2)
write("planar_tiles.tif", planar, planarconfig="separate", photometric="minisblack", tile=(16, 16),
      metadata=None)
write("planar_rgb.tif", np.moveaxis(rgb, -1, 0).copy(), planarconfig="separate", photometric="rgb",
      metadata=None)
write("chunky_channels.tif", np.stack([plane(), plane(1)], axis=-1).astype("uint16"),
      planarconfig="contig", photometric="minisblack", metadata=None)
write("rgba.tif", np.concatenate([rgb, (plane() % 2 * 255)[..., None].astype("uint8")], axis=-1),
      photometric="rgb", extrasamples=["unassalpha"], metadata=None)

for kind in ["int8", "int16", "int32", "int64", "uint32", "uint64", "float16", "float64"]:
    write(f"{kind}.tif", (plane() - 60).astype(kind) if kind[0] != "u" else plane().astype(kind),
          metadata=None)
write("big_labels.tif", np.where(plane() < 40, 0, 2**24 + plane()).astype("uint32"), metadata=None)
write("white_is_zero.tif", plane().astype("uint8"), photometric="miniswhite", metadata=None)
write("palette.tif", (plane() % 4).astype("uint8"), photometric="palette",
      colormap=np.arange(768, dtype="uint16").reshape(3, 256), metadata=None)
write("one_bit.tif", (plane() % 3 == 0), photometric="minisblack", metadata=None)
write("not_a_number.tif", np.where(plane() == 35, np.nan, plane()).astype("float32"), metadata=None)
write("zstd.tif", plane().astype("uint16"), compression="zstd", metadata=None)
write("jpeg.tif", np.zeros((16, 16), "uint8"), compression="jpeg", metadata=None)
write("centimetre.tif", plane().astype("uint8"), resolution=(10_000 / 0.27, 10_000 / 0.27),
      resolutionunit="centimeter", metadata=None)
write("print.tif", plane().astype("uint8"), resolution=(300, 300), resolutionunit="inch",
      metadata=None)
with tifffile.TiffWriter("thumbnail.tif") as file:
    file.write(plane().astype("uint8"), metadata=None)
    file.write(plane()[::3, ::3].astype("uint8"), subfiletype=1, metadata=None)
    file.write(plane(frame=1).astype("uint8"), metadata=None)
with tifffile.TiffWriter("pyramid.tif") as file:
    file.write(plane().astype("uint8"), subifds=1, metadata=None)
    file.write(plane()[::2, ::2].astype("uint8"), subfiletype=1, metadata=None)

# PNG: a palette of 2 bits with its first colour transparent; grey with opacity; one grey value that is
# transparent.
palette = Image.fromarray((plane() % 4).astype("uint8"), mode="P")
palette.putpalette([9, 9, 9, 255, 0, 0, 0, 255, 0, 7, 7, 7])
palette.save("palette.png", bits=2, transparency=0)
grey = plane().astype("uint8")
Image.fromarray(np.stack([grey, plane().astype("uint8") % 2], axis=-1), mode="LA").save("opacity.png")
Image.fromarray(grey).save("transparent_grey.png", transparency=35)
