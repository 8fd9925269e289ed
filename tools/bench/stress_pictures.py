"""Pictures of tools/bench/stress_peers.py: what the display shows of them, how far apart two are, and a sheet of many."""
import dataclasses

import numpy
import OpenImageIO as oiio

STEPS = 255          # of eight bits, in which differences are told
BLOCK = 4            # pixels a side: noise averages out over a block, what is missing or speckled does not
BAD_BLOCK = 16       # steps


@dataclasses.dataclass
class Difference:
    """Of the averages of blocks, in steps of eight bits on the display."""
    mean: float          # over blocks and R, G, B
    largest: float
    bad_blocks: int      # that differ by more than BAD_BLOCK steps in R, G or B
    blocks: int


def read(file):
    """Rows of R, G, B: linear of an EXR, display values of a PNG."""
    return oiio.ImageBuf(str(file)).get_pixels(oiio.FLOAT)[..., :3]


def not_finite(linear):
    return int(numpy.count_nonzero(~numpy.isfinite(linear)))


def shown(linear, exposure_stops):
    """What an sRGB display shows, 0 to 1; what is not finite is white, so that it shows."""
    value = numpy.nan_to_num(linear.astype(numpy.float64) * 2.0**exposure_stops, nan=1, posinf=1, neginf=0).clip(0, 1)
    return numpy.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)


def block_averages(picture):
    height, width, channels = picture.shape
    y, x = min(BLOCK, height), min(BLOCK, width)
    return picture[:height // y * y, :width // x * x].reshape(height // y, y, width // x, x, channels).mean((1, 3))


def difference(a, b):
    """@pre two shown pictures of one size"""
    off = STEPS * numpy.abs(block_averages(a) - block_averages(b))
    worst = off.max(axis=2)
    return Difference(float(off.mean()), float(worst.max()), int(numpy.count_nonzero(worst > BAD_BLOCK)), worst.size)


def missing(shape):
    """Stands for a picture that was not made: grey, where a black one may be what was rendered."""
    return numpy.full(shape, 0.25)


def labelled(picture, text, scale):
    """Enlarged, above a line of text."""
    tile = numpy.repeat(numpy.repeat(picture, scale, 0), scale, 1)
    strip = oiio.ImageBuf(oiio.ImageSpec(tile.shape[1], 16, 3, oiio.FLOAT))
    oiio.ImageBufAlgo.render_text(strip, 2, 12, text, 11, textcolor=(1, 1, 1))  # without fonts the strip stays black
    return numpy.concatenate([tile, strip.get_pixels(oiio.FLOAT)], 0)


def write_sheet(file, rows, scale=3, columns=3):
    """@param rows  (text, pictures of one size, side by side)"""
    tiles = [labelled(numpy.concatenate(pictures, 1), text, scale) for text, pictures in rows]
    height, width = (max(tile.shape[axis] for tile in tiles) for axis in (0, 1))
    lines = -(-len(tiles) // columns)
    sheet = numpy.zeros((lines * height, columns * (width + 6), 3), numpy.float32)
    for i, tile in enumerate(tiles):
        y, x = i // columns * height, i % columns * (width + 6)
        sheet[y:y + tile.shape[0], x:x + tile.shape[1]] = tile
    image = oiio.ImageBuf(oiio.ImageSpec(sheet.shape[1], sheet.shape[0], 3, oiio.UINT8))
    image.set_pixels(oiio.ROI(0, sheet.shape[1], 0, sheet.shape[0], 0, 1, 0, 3), sheet)
    if not image.write(str(file)):
        raise RuntimeError(f"cannot write {file}: {image.geterror()}")
