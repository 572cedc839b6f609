#!/usr/bin/env python3
"""Images that come by `--board igtl=`, from servers that are written here and by the library's own example,
against the same voxels in files; and what must not get in."""
import json
import os
import pathlib
import signal
import socket
import struct
import subprocess
import time
import unittest

import numpy as np

import igtl
from support import BALL_SCENE, InFolder, PROGRAM, SMOOTH, off_ball, run, settings, twice

FRAMES, LINES, SAMPLES = 9, 24, 96
POLAR = {"wobblebench_content": "polar", "wobblebench_radius_mm": "40", "wobblebench_wobble_radius_mm": "27",
         "wobblebench_sector_deg": "70", "wobblebench_fan_deg": "50", "wobblebench_depth_mm": "150",
         "wobblebench_dynamic_range_db": "60"}
GEOMETRY = """[geometry]
layout = "polar"
radius_mm = 40
wobble_radius_mm = 27
sector_deg = 70
fan_deg = 50
depth_mm = 150
dynamic_range_db = 60
"""


def polar(volume):
    """A ball in the polar volume, brighter on one side, and different in each volume."""
    f, l, k = np.indices((FRAMES, LINES, SAMPLES))
    inside = (f - 4) ** 2 / 9 + (l - 9) ** 2 / 49 + (k - 60) ** 2 / 400 < 1
    return np.where(inside, 120 + 3 * l + volume, 5).astype(np.uint8)


def numbered(volume, frame=None):
    about = dict(POLAR, wobblebench_volume=str(volume))
    if frame is not None:
        about["wobblebench_frame"] = str(frame)
    return about


def serve(messages):
    """A server that sends these, and closes."""
    data = b"".join(messages)
    return igtl.Server(lambda connection: connection.sendall(data))


def volumes(numbers):
    return [igtl.image(polar(v), metadata=numbered(v), version=2) for v in numbers]


class Received(InFolder):
    def board(self, server, *keys):
        self.addCleanup(server.close)
        return ",".join([f"igtl=127.0.0.1:{server.port}", *keys])

    def exported(self, name, board, count, *options):
        """Polar samples of volumes, as `export` writes what came."""
        file = self.path(name + ".npz")
        run("export", board, "--to", file + ",content=polar", "--volumes", count, *options)
        return np.load(file)

    def geometry(self, *lines):
        file = self.path("geometry.toml")
        with open(file, "w", encoding="utf-8") as out:
            out.write(GEOMETRY + "\n".join(lines))
        return "geometry=" + file

    def expect(self, scan, count):
        self.assertEqual(str(scan["source"][0]), "recording of hardware")
        expected = np.stack([polar(v) for v in range(count)]) / 255
        np.testing.assert_allclose(scan["samples"], expected, atol=1e-6)
        np.testing.assert_allclose(scan["motor_angle_deg"][0][:, 0], np.linspace(-25, 25, FRAMES))

    def test_volumes_whose_metadata_describe_them(self):
        scan = self.exported("metadata", self.board(serve(volumes(range(3)))), 3)
        self.expect(scan, 3)
        self.assertTrue(scan["arrived"].all())

    def test_volumes_of_sixteen_bits_in_either_order_and_a_geometry_file(self):
        for order in "<>":
            wide = [igtl.image((polar(v).astype(np.uint32) * 257).astype(order + "u2")) for v in range(2)]
            board = self.board(serve(wide), self.geometry("black = 0", "white = 65535"))
            self.expect(self.exported("wide" + str(ord(order)), board, 2), 2)

    def test_numbered_planes_in_any_order(self):
        order = np.random.default_rng(1).permutation(FRAMES)
        planes = [igtl.image(polar(v)[f][None], metadata=dict(numbered(v, f), wobblebench_frames_per_volume="9"),
                             version=2) for v in range(2) for f in order]
        self.expect(self.exported("planes", self.board(serve(planes)), 2), 2)

    def test_planes_in_order_with_gaps_in_their_times(self):
        planes = [igtl.image(polar(v)[f][None], seconds=10 + 0.025 * (v * FRAMES + f)) for v in range(2)
                  for f in range(FRAMES) if (v, f) not in ((0, 3), (1, 0), (1, 1))]
        board = self.board(serve(planes), "planes=in_order", "period_ms=25", self.geometry("frames_per_volume = 9"))
        scan = self.exported("gaps", board, 2)
        lost = np.zeros((2, FRAMES), bool)
        lost[0, 3] = lost[1, 0] = lost[1, 1] = True
        np.testing.assert_array_equal(scan["arrived"].all(-1), ~lost)
        np.testing.assert_allclose(scan["samples"][1, 5], polar(1)[5] / 255, atol=1e-6)

    def test_a_grid_on_either_axes_is_that_of_the_file(self):
        """The same voxels as .nrrd and as messages in RAS and LPS give the same sticks."""
        k, j, i = np.indices((30, 26, 22))
        grid = np.where((i - 6) ** 2 + (j - 15) ** 2 + (k - 12) ** 2 < 40, 180 + i, 9).astype(np.uint8)
        origin, step = np.array([-30.0, -35.0, 60.0]), 3.0
        file = self.path("grid.nrrd")
        with open(file, "wb") as out:
            out.write(b"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 22 26 30\n"
                      b"space directions: (3,0,0) (0,3,0) (0,0,3)\nspace origin: (-30,-35,60)\n"
                      b"encoding: raw\n\n" + grid.tobytes())
        toml = self.path("grid.toml")
        with open(toml, "w", encoding="utf-8") as out:
            out.write(GEOMETRY.replace('"polar"', '"cartesian"'))
        by_file = self.exported("by_file", f"file={file},geometry={toml}", 1)
        center = origin + step * (np.array(grid.shape[::-1]) - 1) / 2
        for axes, sign in ((1, np.array([-1, -1, 1])), (2, np.ones(3))):
            message = igtl.image(grid, step * np.diag(sign), sign * center, axes)
            scan = self.exported(f"grid{axes}", self.board(serve([message]), "geometry=" + toml), 1)
            self.assertGreater(by_file["samples"].max(), 0.7)
            np.testing.assert_allclose(scan["samples"], by_file["samples"], atol=1e-5)

    def test_lost_volumes_are_counted(self):
        board = self.board(serve(volumes([0, 1, 4])))
        out = self.path("lost")
        run("record", "--board", board, "--out", out)
        with open(os.path.join(out, "recording.json"), encoding="utf-8") as report:
            account = json.load(report)["board"]
        self.assertEqual(account["delivered"], 3 * FRAMES * LINES)
        self.assertEqual(account["lost_link"], 2 * FRAMES * LINES)

    def test_what_is_left_out_is_said(self):
        good = volumes(range(2))
        broken = bytearray(volumes([7])[0])
        broken[-1] ^= 1
        colour = igtl.IMAGE.pack(1, 3, 3, 2, 1, 2, 2, 1, *np.eye(3).ravel(), 0, 0, 0, 0, 0, 0, 2, 2, 1) + bytes(12)
        others = [igtl.message("TRANSFORM", bytes(48)), igtl.message("STATUS", bytes(31)),
                  igtl.message("IMAGE", colour), bytes(broken), igtl.message("X_OF_OURS", b"")]
        board = self.board(serve([*others, *good, *others[:1]]))
        answer = run("record", "--board", board, "--out", self.path("said"))
        for part in ("TRANSFORM messages (2)", "STATUS messages (1)", "X_OF_OURS messages (1)",
                     "images: has a wrong CRC (1)", "images: is of colours (1)"):
            self.assertIn(part, answer)

    def test_a_picture_is_rendered_and_never_scored(self):
        board = self.board(serve(volumes(range(2))))
        out = self.path("run")
        run("run", "--board", board, "--out", out, *settings("render.ray_casting.image_size=64"))
        with open(os.path.join(out, "report.json"), encoding="utf-8") as report:
            self.assertTrue(json.load(report)["no_truth_because"])

    def test_it_takes_what_stream_sends(self):
        """Polar samples and a grid, over the loopback interface, give the sticks of the files that `export` writes.
        Without speckle and noise each volume is the same."""
        scene = BALL_SCENE + SMOOTH + settings("acquisition.frames_per_volume=11", "render.ray_casting.image_size=64")
        for content, options in (("polar", ",content=polar,type=uint16"), ("volume", ",spacing_mm=2,type=uint16")):
            file = self.path(content + ".nrrd")
            run("export", "sim", *scene, "--to", file + options)
            sender = subprocess.Popen(
                [PROGRAM, "stream", *scene, "--volumes", "40", "--send", f"igtl=0,content={content},type=uint16",
                 "--out", self.path("sender_" + content), "--codec", "none", "--errors", "0"],
                stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
            port = next(line for line in sender.stderr if "OpenIGTLink at" in line).rsplit(":", 1)[1].strip()
            scan = self.exported("by_stream", f"igtl=127.0.0.1:{port}", 1, "--replace")
            sender.communicate(timeout=600)
            self.assertEqual(sender.returncode, 0)
            by_file = self.exported("by_file", "file=" + file, 1, "--replace")
            np.testing.assert_allclose(scan["samples"], by_file["samples"], atol=1e-5)
            samples, off = scan["samples"][0], off_ball(scan)
            self.assertGreater((off < -3).sum(), 400)
            self.assertGreater(samples[off < -3].min(), 0.3)
            self.assertLess(samples[off > 6].max(), 0.1)

    @unittest.skipUnless("WOBBLEBENCH_IGTL_IMAGER_SERVER" in os.environ, "built without openigtlink-examples")
    def test_planes_of_the_library_s_example(self):
        """It sends its five pictures in turn, at positions by chance, which polar samples do not have."""
        folder = os.environ["WOBBLEBENCH_IGTL_IMAGES"]
        pictures = [np.fromfile(f"{folder}/igtlTestImage{i}.raw", np.uint8).reshape(256, 256) for i in range(1, 6)]
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        example = subprocess.Popen([os.environ["WOBBLEBENCH_IGTL_IMAGER_SERVER"], str(port), "50", folder],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(example.wait)
        self.addCleanup(example.terminate)
        for _ in range(100):
            time.sleep(0.05)
            if f":{port:04X} 00000000:0000 0A" in pathlib.Path("/proc/net/tcp").read_text(encoding="ascii"):
                break
        scan = self.exported("example", f"igtl=127.0.0.1:{port},planes=in_order,"
                             + self.geometry("frames_per_volume = 5"), 2)
        np.testing.assert_allclose(scan["samples"], np.stack([pictures, pictures]) / 255, atol=1e-6)

    def test_the_contract_holds(self):
        """Each opening gets volumes from the first on."""
        many = volumes(range(16))
        board = self.board(serve(many))
        answer = run("conformance", "--board", board, "--out", self.path("conformance"))
        self.assertIn("0 failed", answer)


class Hostile(InFolder):
    """Each is refused by one line, or counted; the program ends by itself, and in twice the memory of an honest one."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.most = twice("record", "--board", f"igtl=127.0.0.1:{serve(volumes([0, 1])).port}", "--out", cls.path("good"))

    def refused(self, data, *why, keys="", code=2, hold=False):
        def send(connection):
            connection.sendall(data)
            if hold:
                time.sleep(20)
        self.refused_server(send, why, keys, code)

    def refused_server(self, send, why, keys, code):
        server = igtl.Server(send)
        self.addCleanup(server.close)
        out = self.path(f"hostile{server.port}")
        answer = run("record", "--board", f"igtl=127.0.0.1:{server.port}{keys}", "--out", out, code=code, most=self.most)
        lines = [line for line in answer.splitlines() if "--board" in line]
        self.assertEqual(len(lines), 1, answer)
        for part in why:
            self.assertIn(part, lines[0])
        if code == 2:
            self.assertFalse(os.path.exists(out))

    def header(self, kind=b"IMAGE", size=0, version=1, crc=0):
        return igtl.HEADER.pack(version, kind, b"x", 0, size, crc)

    def test_no_server(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        answer = run("record", "--board", f"igtl=127.0.0.1:{port}", "--out", self.path("none"), code=2)
        self.assertIn("Connection refused; must be a server of OpenIGTLink", answer)

    def test_bad_arguments(self):
        for board, why in (("igtl", "must be PORT or HOST:PORT"), ("igtl=h:0", "from 1 to 65535"),
                           ("igtl=h:1,pace=asap", "no such key; igtl takes"),
                           ("igtl=h:1,planes=any", "must be one of numbered, in_order"),
                           ("igtl=h:1,geometry=", "geometry is empty"),
                           ("igtl=h:1,patience_s=0", "patience_s = 0: must be")):
            self.assertIn(why, run("record", "--board", board, "--out", self.path("bad"), code=2))

    def test_what_is_no_message(self):
        self.refused(b"HTTP/1.1 200 OK\r\n\r\n" * 10, "sends what is no message of OpenIGTLink")
        self.refused(self.header(version=0) + bytes(100), "sends what is no message")
        self.refused(self.header(kind=b"\xff\x01"), "sends what is no message")

    def test_nothing_and_silence(self):
        self.refused(b"", "the server closed the connection; must send a grey IMAGE")
        self.refused(volumes([0])[0][:500], "no image came for 0.5 s", keys=",patience_s=0.5", hold=True)

    def test_a_flood_without_an_image_ends_after_the_patience(self):
        """Also of damaged images, and one message at a time."""
        broken = bytearray(volumes([0])[0])
        broken[-1] ^= 1
        for flood, pause, what in ((igtl.message("TRANSFORM", bytes(48)), 0.1, "TRANSFORM messages ("),
                                   (igtl.message("STATUS", bytes(31)) * 5000, 0, "STATUS messages ("),
                                   (bytes(broken) * 50, 0, "images: has a wrong CRC (")):
            def send(connection, flood=flood, pause=pause):
                while True:
                    connection.sendall(flood)
                    time.sleep(pause)
            self.refused_server(send, ["no image came for 0.6 s; must send a grey IMAGE, and sent " + what],
                                ",patience_s=0.6", 2)

    def test_neither_silence_nor_a_flood_delays_an_interruption(self):
        flood = igtl.message("STATUS", bytes(31)) * 5000

        def send(connection):
            connection.sendall(volumes([0])[0])
            while True:
                connection.sendall(flood)
        for serve, how in ((send, signal.SIGINT), (lambda connection: connection.recv(1), signal.SIGTERM)):
            server = igtl.Server(serve)
            self.addCleanup(server.close)
            child = subprocess.Popen([PROGRAM, "record", "--board", f"igtl=127.0.0.1:{server.port}", "--out",
                                      self.path("ended")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.addCleanup(child.kill)
            time.sleep(2)
            child.send_signal(how)
            self.assertIn("interrupted", child.communicate(timeout=4)[0])

    def test_two_planes_of_a_huge_fan_take_the_memory_of_two(self):
        """A volume of 1024 such planes has 268 MB a copy."""
        plane = np.full((1, 128, 512), 9, np.uint8)
        about = dict(POLAR, wobblebench_frames_per_volume="1024")
        data = b"".join(igtl.image(plane, metadata=dict(about, wobblebench_volume=str(v), wobblebench_frame="0"),
                                   version=2) for v in range(2))
        server = serve([data])
        self.addCleanup(server.close)
        child = os.posix_spawn(PROGRAM, [PROGRAM, "record", "--board", f"igtl=127.0.0.1:{server.port}",
                                         "--out", self.path("huge")], os.environ)
        _, status, used = os.wait4(child, 0)
        self.assertEqual(status, 0)
        self.assertLess(used.ru_maxrss, 200_000)

    def test_cut_messages(self):
        data = volumes([0])[0]
        for end in (10, 57, 58, 100, len(data) - 1):
            self.refused(data[:end], "closed the connection within a message")

    def test_absurd_sizes(self):
        self.refused(self.header(size=2**63), "announces a message of 9223372036854775808 bytes")
        self.refused(self.header(size=2**32 - 1), "closed the connection within a message")
        for sizes in ((65535, 65535, 65535), (0, 4, 4), (2, 2, 3)):
            content = igtl.IMAGE.pack(1, 1, 3, 2, 1, *sizes, *np.eye(3).ravel(), 0, 0, 0, 0, 0, 0, *sizes) + bytes(8)
            self.refused(igtl.message("IMAGE", content), "must send a grey IMAGE, and sent images:")

    def test_images_that_are_none(self):
        eye, size = np.eye(3).ravel(), (2, 2, 2)
        bad = eye.copy()
        bad[4] = np.nan
        for fields, why in (((1, 1, 9, 2, 1, *size, *eye, 0, 0, 0, 0, 0, 0, *size), "unknown type of numbers, 9"),
                            ((1, 1, 3, 7, 1, *size, *eye, 0, 0, 0, 0, 0, 0, *size), "unknown byte order, 7"),
                            ((1, 1, 3, 2, 9, *size, *eye, 0, 0, 0, 0, 0, 0, *size), "system of coordinates, 9"),
                            ((1, 1, 3, 2, 1, *size, *bad, 0, 0, 0, 0, 0, 0, *size), "not finite"),
                            ((1, 1, 3, 2, 1, *size, *eye, 0, 0, 0, 1, 0, 0, *size), "a part of an image"),
                            ((1, 1, 3, 2, 1, *size, *eye, 0, 0, 0, 0, 0, 0, 2, 2, 1), "a part of an image")):
            self.refused(igtl.message("IMAGE", igtl.IMAGE.pack(*fields) + bytes(8)), why)
        self.refused(igtl.message("IMAGE", bytes(30)), "is shorter than it says")

    def test_metadata_that_do_not_fit(self):
        image = igtl.image(polar(0))[58:]
        for body in (struct.pack(">HHII", 12, 10, 2**32 - 1, 0) + image, struct.pack(">HHII", 60000, 2, 0, 0) + image,
                     struct.pack(">HHII", 12, 10, 0, 0) + image + struct.pack(">HHHI", 1, 5, 3, 2**31),
                     struct.pack(">HHII", 12, 4, 0, 0) + image + struct.pack(">HH", 65535, 0)):
            data = igtl.HEADER.pack(2, b"IMAGE", b"x", 0, len(body), igtl.crc64(body)) + body
            self.refused(data, "images: is shorter than it says")
        body = struct.pack(">HHII", 12, 2, 70000, 0) + image + struct.pack(">H", 0) + bytes(70000)
        self.refused(igtl.HEADER.pack(2, b"IMAGE", b"x", 0, len(body), igtl.crc64(body)) + body,
                     "has too much metadata")

    def test_what_is_not_described(self):
        self.refused(igtl.image(polar(0)), "does not say how it was scanned; must be given with geometry=FILE.toml")
        about = dict(POLAR, wobblebench_radius_mm="nan")
        self.refused(igtl.image(polar(0), metadata=about, version=2), "wobblebench_radius_mm = nan")
        plane = igtl.image(polar(0)[:1], metadata=numbered(0, 0), version=2)
        self.refused(plane, "geometry.frames_per_volume: is missing")
        about = dict(POLAR, wobblebench_frames_per_volume="9")
        self.refused(igtl.image(polar(0)[:1], metadata=about, version=2), "planes=in_order")

    def test_images_that_change(self):
        data = volumes([0])[0] + igtl.image(polar(1)[:, :, :50], metadata=numbered(1), version=2)
        self.refused(data, "the images change their size or type", code=1)

    def test_a_server_that_breaks_off(self):
        data = b"".join(volumes([0, 1]))
        self.refused(data[:-7], "the server closed the connection within a message", code=1)

    def test_voxels_that_are_no_numbers(self):
        bad = polar(1).astype("f4")
        bad[2, 3, 4] = np.inf
        scale = dict(wobblebench_white="255")
        data = [igtl.image(values, metadata=dict(numbered(v), **scale), version=2)
                for v, values in enumerate((polar(0).astype("f4"), bad, polar(2).astype("f4")))]
        self.refused(b"".join(data), "volumes: with voxels that are no finite numbers (1)", code=0)

    def test_a_plane_that_is_no_number_drops_its_own_volume_alone(self):
        bad = polar(0).astype("f4")
        bad[2, 3, 4] = np.nan
        about = {"wobblebench_white": "255", "wobblebench_frames_per_volume": "9"}
        data = [igtl.image(values[f][None], metadata=dict(numbered(v, f), **about), version=2)
                for v, values in enumerate((bad, *(polar(k).astype("f4") for k in (1, 2))))
                for f in range(FRAMES) if v == 0 or f != 2]
        self.refused(b"".join(data), "volumes: with voxels that are no finite numbers (1)", code=0)


if __name__ == "__main__":
    unittest.main()
