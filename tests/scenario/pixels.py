# Pictures of tests: rows of RGB bytes from PNG files with plain or filtered rows, and from PPM files.
import zlib


def unfiltered(kind, row, above, pixel):
    out = bytearray(row)
    for i in range(len(out)):
        left, up, corner = (out[i - pixel] if i >= pixel else 0), above[i], (above[i - pixel] if i >= pixel else 0)
        if kind == 1:
            out[i] = (out[i] + left) & 255
        elif kind == 2:
            out[i] = (out[i] + up) & 255
        elif kind == 3:
            out[i] = (out[i] + (left + up) // 2) & 255
        elif kind == 4:
            guess = left + up - corner
            near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            out[i] = (out[i] + near) & 255
    return bytes(out)


def png(path, channels=3, bits=8):
    """Width, height and the bytes of a picture: grey (1), RGB (3) or RGBA (4); of 16 bits the high one comes first."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", f"{path}: no PNG"
    at, packed = 8, b""
    while at < len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
            assert body[8:10] == bytes((bits, {1: 0, 3: 2, 4: 6}[channels])), f"{path}: expected {bits} bits and {channels} channels"
        if kind == b"IDAT":
            packed += body
        at += length + 12
    pixel = channels * bits // 8
    raw, step, rows = zlib.decompress(packed), pixel * width + 1, [bytes(pixel * width)]
    for y in range(height):
        rows.append(unfiltered(raw[y * step], raw[y * step + 1 : (y + 1) * step], rows[-1], pixel))
    return width, height, b"".join(rows[1:])


def ppm(path):
    with open(path, "rb") as file:
        head, size, _, body = file.read().split(b"\n", 3)
    assert head == b"P6"
    width, height = map(int, size.split())
    return width, height, body
