"""OpenIGTLink by the published protocol (Documents/Protocol of the library's repository), with struct and
numpy alone: reads and makes messages of header versions 1 and 2, and checks their CRC."""
import socket
import struct

import numpy as np

HEADER = struct.Struct(">H12s20sQQQ")
EXTENDED = struct.Struct(">HHII")
IMAGE = struct.Struct(">HBBBB3H12f3H3H")
SCALARS = {2: "i1", 3: "u1", 4: "i2", 5: "u2", 6: "i4", 7: "u4", 10: "f4", 11: "f8"}
POLYNOMIAL = 0x42F0E1EBA9EA3693  # ECMA-182


def _table():
    table = []
    for byte in range(256):
        rest = byte << 56
        for _ in range(8):
            rest = (rest << 1) ^ (POLYNOMIAL if rest >> 63 else 0)
            rest &= 0xFFFFFFFFFFFFFFFF
        table.append(rest)
    return table


TABLE = np.array(_table(), np.uint64)
ROWS = 1024


def _fed(crcs, columns):
    """Remainders after more bytes, [row] with [column][row]."""
    for column in columns:
        crcs = TABLE[((crcs >> np.uint64(56)) ^ column).astype(np.intp)] ^ (crcs << np.uint64(8))
    return crcs


def crc64(data):
    """Of rows side by side, which are then joined: a remainder is linear, and zeros in front do not change it."""
    width = -(-len(data) // ROWS)
    padded = np.zeros(ROWS * width, np.uint64)
    if len(data) > 0:
        padded[-len(data):] = np.frombuffer(data, np.uint8)
    rows = _fed(np.zeros(ROWS, np.uint64), padded.reshape(ROWS, width).T)
    moved = [int(bit) for bit in _fed(np.uint64(1) << np.arange(64, dtype=np.uint64), np.zeros((width, 64), np.uint64))]
    crc = 0
    for row in rows:
        joined = int(row)
        for bit in range(64):
            if crc >> bit & 1:
                joined ^= moved[bit]
        crc = joined
    return crc


class Message:
    """One message: its header, metadata and content."""

    def __init__(self, header, body, check=True):
        self.version, kind, device, self.timestamp, size, crc = HEADER.unpack(header)
        self.kind, self.device = (text.rstrip(b"\0").decode("ascii") for text in (kind, device))
        assert size == len(body)
        if check:
            assert crc == crc64(body), f"CRC of {self.kind} {self.device}"
        self.metadata, self.content = {}, body
        if self.version >= 2:
            extended, index_bytes, value_bytes, _ = EXTENDED.unpack_from(body)
            end = len(body) - index_bytes - value_bytes
            self.content = body[extended:end]
            self._read_metadata(body[end:end + index_bytes], body[end + index_bytes:])

    def _read_metadata(self, index, values):
        (count,) = struct.unpack_from(">H", index)
        assert len(index) == 2 + 8 * count
        at = 0
        for i in range(count):
            key_bytes, encoding, value_bytes = struct.unpack_from(">HHI", index, 2 + 8 * i)
            assert encoding == 3  # US-ASCII
            key = values[at:at + key_bytes].decode("ascii")
            at += key_bytes
            self.metadata[key] = values[at:at + value_bytes].decode("ascii")
            at += value_bytes
        assert at == len(values)

    @property
    def seconds(self):
        return (self.timestamp >> 32) + (self.timestamp & 0xFFFFFFFF) / 2**32


class Image:
    """Voxels [k, j, i] or [k, j, i, component], and positions in mm."""

    def __init__(self, message):
        fields = IMAGE.unpack_from(message.content)
        version, components, scalar, endian, self.coordinates = fields[:5]
        assert version == 1
        size = fields[5:8]
        matrix = np.array(fields[8:20], float).reshape(4, 3)
        assert fields[20:23] == (0, 0, 0) and fields[23:26] == size
        self.steps, self.center = matrix[:3], matrix[3]
        kind = np.dtype((">" if endian == 1 else "<") + SCALARS[scalar])
        shape = size[::-1] + ((components,) if components > 1 else ())
        self.voxels = np.frombuffer(message.content, kind, offset=IMAGE.size).reshape(shape)

    def positions(self):
        """[k, j, i, 3]; the message says where the middle of the whole image lies."""
        k, j, i = (np.arange(n) - (n - 1) / 2 for n in self.voxels.shape[:3])
        return (self.center + i[None, None, :, None] * self.steps[0] + j[None, :, None, None] * self.steps[1] +
                k[:, None, None, None] * self.steps[2])


def surface(message):
    """Points [n, 3] in mm, and corners [m, 3]."""
    counts = struct.unpack_from(">10I", message.content)
    points, polygons, polygon_bytes = counts[0], counts[5], counts[6]
    assert counts[1:5] == (0, 0, 0, 0) and counts[7:] == (0, 0, 0)
    corners_at = 40 + 12 * points
    assert corners_at + polygon_bytes == len(message.content)
    corners = np.frombuffer(message.content, ">u4", offset=corners_at).reshape(polygons, 4)
    assert polygons == 0 or (corners[:, 0] == 3).all()
    return np.frombuffer(message.content, ">f4", 3 * points, 40).reshape(points, 3), corners[:, 1:]


def transform(message):
    """4 x 4, points as columns."""
    matrix = np.eye(4)
    matrix[:3] = np.frombuffer(message.content, ">f4").reshape(4, 3).T
    return matrix


def status(message):
    code, _ = struct.unpack_from(">Hq", message.content)
    return code, message.content[30:].rstrip(b"\0").decode("ascii")


def receive_exactly(connection, size):
    """Bytes; fewer where the other side has closed."""
    data = bytearray()
    while len(data) < size:
        piece = connection.recv(min(size - len(data), 1 << 20))
        if not piece:
            break
        data += piece
    return bytes(data)


def receive_all(connection):
    """Messages until the other side closes."""
    while True:
        header = receive_exactly(connection, HEADER.size)
        if not header:
            return
        assert len(header) == HEADER.size
        size = HEADER.unpack(header)[4]
        body = receive_exactly(connection, size)
        assert len(body) == size, "a message was cut"
        yield Message(header, body)


def message(kind, content, device="Test", seconds=0.0, metadata=None, version=1):
    """Bytes of a message."""
    body = content
    if version >= 2:
        entries = [(key.encode(), value.encode()) for key, value in (metadata or {}).items()]
        index = struct.pack(">H", len(entries)) + b"".join(
            struct.pack(">HHI", len(key), 3, len(value)) for key, value in entries)
        values = b"".join(key + value for key, value in entries)
        body = EXTENDED.pack(EXTENDED.size, len(index), len(values), 0) + content + index + values
    stamp = (int(seconds) << 32) + int(seconds % 1 * 2**32)
    return HEADER.pack(version, kind.encode(), device.encode(), stamp, len(body), crc64(body)) + body


def image(voxels, steps=None, center=(0, 0, 0), coordinates=1, **about):
    """Bytes of an IMAGE of voxels [k, j, i]."""
    steps = np.eye(3) if steps is None else np.asarray(steps)
    kind = voxels.dtype
    scalar = next(code for code, name in SCALARS.items() if name == kind.str[1:])
    size = voxels.shape[::-1]
    header = IMAGE.pack(1, 1, scalar, 1 if kind.str[0] == ">" else 2, coordinates, *size,
                        *steps.ravel(), *center, 0, 0, 0, *size)
    return message("IMAGE", header + voxels.tobytes(), **about)


class Server:
    """Listens on the loopback address and serves one client after the other by `serve(connection)`."""

    def __init__(self, serve):
        import threading
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.serve = serve
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            with connection:
                try:
                    self.serve(connection)
                except OSError:
                    pass  # the client has left

    def close(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
