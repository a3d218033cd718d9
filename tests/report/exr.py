"""OpenEXR files of 32-bit floats without compression: what a test needs to know every number in a picture."""
import struct


def write_exr(path, width, height, channels):
    """channels: {name: function of (x, y)}."""
    names = sorted(channels)

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    listed = b"".join(name.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2) + b"".join((
        attribute("channels", "chlist", listed), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    line_bytes = 8 + 4 * width * len(names)
    first = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header)
        for y in range(height):
            file.write(struct.pack("<Q", first + y * line_bytes))
        for y in range(height):
            file.write(struct.pack("<ii", y, line_bytes - 8))
            for name in names:
                file.write(struct.pack(f"<{width}f", *(channels[name](x, y) for x in range(width))))
