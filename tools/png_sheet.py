"""Sheets of pictures side by side, as PNG files, with nothing but the standard library: crops, magnified by whole numbers."""
import pathlib
import struct
import zlib


class Picture:
    """8-bit RGB, row after row."""

    def __init__(self, width, height, rows):
        self.width, self.height, self.rows = width, height, rows

    def crop(self, x, y, width, height):
        """What of the rectangle lies in the picture, black elsewhere."""
        rows = []
        for j in range(y, y + height):
            row = self.rows[j] if 0 <= j < self.height else b""
            left, right = max(0, x), min(self.width, x + width)
            inside = row[3 * left:3 * right]
            rows.append((b"\0\0\0" * min(width, left - x) + inside).ljust(3 * width, b"\0"))
        return Picture(width, height, rows)

    def magnified(self, times):
        rows = []
        for row in self.rows:
            wide = b"".join(row[i:i + 3] * times for i in range(0, len(row), 3)) if times > 1 else row
            rows += [wide] * times
        return Picture(self.width * times, self.height * times, rows)

    def threshold(self):
        """White where anything is not black."""
        rows = [b"".join(b"\xff\xff\xff" if any(row[i:i + 3]) else b"\0\0\0" for i in range(0, len(row), 3)) for row in self.rows]
        return Picture(self.width, self.height, rows)


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def unfilter(kind, row, above, step):
    """PNG specification, clause 9.2."""
    if kind == 1:
        for i in range(step, len(row)):
            row[i] = (row[i] + row[i - step]) & 255
    elif kind == 2:
        row[:] = bytes((x + y) & 255 for x, y in zip(row, above))
    elif kind == 3:
        for i in range(len(row)):
            row[i] = (row[i] + ((row[i - step] if i >= step else 0) + above[i]) // 2) & 255
    elif kind == 4:
        for i in range(len(row)):
            row[i] = (row[i] + (paeth(row[i - step], above[i], above[i - step]) if i >= step else above[i])) & 255


def read_png(path, rows=None):
    """The first `rows` rows (all without it) of an 8-bit RGB, RGBA or gray PNG that is not interlaced."""
    data, at, body = pathlib.Path(path).read_bytes(), 8, b""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path}: not a PNG file")
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", chunk)
            if depth != 8 or interlaced or color not in (0, 2, 6):
                raise ValueError(f"{path}: only 8-bit gray, RGB and RGBA without interlacing are read")
        elif kind == b"IDAT":
            body += chunk
        at += 12 + size
    step, raw = {0: 1, 2: 3, 6: 4}[color], zlib.decompress(body)
    stride, above, found = width * step, bytes(width * step), []
    for j in range(min(height, rows or height)):
        row = bytearray(raw[j * (stride + 1) + 1:(j + 1) * (stride + 1)])
        unfilter(raw[j * (stride + 1)], row, above, step)
        above = row
        colors = bytearray(3 * width)
        for c in range(3):
            colors[c::3] = row[(c if step > 1 else 0)::step]
        found.append(bytes(colors))
    return Picture(width, len(found), found)


def write_png(path, picture):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + row for row in picture.rows)
    header = struct.pack(">IIBBBBB", picture.width, picture.height, 8, 2, 0, 0, 0)
    pathlib.Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 6)) + chunk(b"IEND", b""))


def sheet(lines, gap=8):
    """Lines of pictures of one size, side by side on white."""
    width = max(sum(p.width + gap for p in line) - gap for line in lines)
    rows, white = [], b"\xff" * (3 * width)
    for line in lines:
        rows += [white] * gap if rows else []
        for j in range(line[0].height):
            rows.append((b"\xff\xff\xff" * gap).join(p.rows[j] for p in line).ljust(3 * width, b"\xff"))
    return Picture(width, len(rows), rows)
