#!/usr/bin/env python3
"""What `wobblebench stream --send` sends, against closed forms, the stream's own files, and a client that is
built on libOpenIGTLink 1.11."""
import json
import os
import re
import socket
import subprocess
import tempfile
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

import igtl
from support import BALL, BALL_SCENE, InFolder, PROGRAM, RADIUS, run, settings

SCENE = BALL_SCENE + settings("render.ray_casting.image_size=160")
STICKS, PERIOD_S = 40 * 21, 2 * 0.16 / 1540
TO_RAS = np.array([-1, -1, 1])  # 3 Slicer's axes, of the probe frame's, which files call LPS


class Stream:
    """One stream, and clients that are connected before its first volume comes."""

    def __init__(self, folder, send, *options, clients=(igtl.receive_all,)):
        self.out = os.path.join(folder, f"out{id(self)}")
        if "clients=" not in send and "wait=" not in send:
            send += f",wait={len(clients)}"
        command = [PROGRAM, "stream", *SCENE, *options, "--send", send, "--out", self.out,
                   "--codec", "none", "--errors", "0"]
        self.received, self.addresses = [[] for _ in clients], [""] * len(clients)
        self.lines = []
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = self._port()
        pool = ThreadPoolExecutor(len(clients))
        readers = [pool.submit(self._client, *each) for each in enumerate(clients)]
        self.output, rest = self.process.communicate(timeout=600)
        for reader in readers:
            reader.result(600)  # raises what the client found wrong
        self.lines.append(rest)
        if self.process.returncode != 0:
            raise AssertionError("".join(self.lines))
        with open(os.path.join(self.out, "report.json"), encoding="utf-8") as report:
            self.report = json.load(report)

    def _port(self):
        for line in self.process.stderr:
            self.lines.append(line)
            if "OpenIGTLink at" in line:
                return int(line.rsplit(":", 1)[1])
        raise AssertionError("".join(self.lines))

    def _client(self, number, receive):
        with socket.create_connection(("127.0.0.1", self.port)) as connection:
            self.addresses[number] = "%s:%d" % connection.getsockname()
            for message in receive(connection):
                self.received[number].append(message)

    def of(self, device, client=0):
        """Messages of a device; there must be some."""
        found = [message for message in self.received[client] if message.device == device]
        assert found, f"no {device} came"
        return found


def never_reads(connection):
    """Until the stream has ended."""
    time.sleep(0.2)
    connection.settimeout(120)
    connection.recv(1, socket.MSG_PEEK)
    while True:
        time.sleep(0.2)
        try:
            connection.send(b"x")
        except OSError:
            return iter(())


def leaves(connection):
    igtl.receive_exactly(connection, 20000)
    return iter(())


class Sent(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        content = "content=picture+volume+polar+surface+pose"
        cls.stream = Stream(cls.folder, f"igtl=0,{content},type=uint16,spacing_mm=2", "--volumes", "3",
                            "--policy", "every", clients=(igtl.receive_all, igtl.receive_all))

    def test_a_stream_begins_and_ends_with_its_status(self):
        for client in (0, 1):
            messages = self.stream.received[client]
            self.assertEqual(igtl.status(messages[0]), (1, "stream begins"))
            code, text = igtl.status(messages[-1])
            self.assertEqual(code, 1)
            self.assertEqual(text, f"stream ends: 3 volumes shown, 0 of {3 * STICKS} sticks lost")

    def test_times_are_those_of_the_sticks(self):
        for device in ("Picture", "Volume", "Polar", "Surface"):
            last = self.stream.of(device)[-1]
            volume = int(last.metadata["wobblebench_volume"])
            self.assertEqual(volume, 2)
            newest_s = ((volume + 1) * STICKS - 1) * PERIOD_S
            self.assertAlmostEqual(last.seconds, newest_s, 8)
            self.assertAlmostEqual(float(last.metadata["wobblebench_newest_stick_s"]), newest_s, 8)
            self.assertAlmostEqual(float(last.metadata["wobblebench_first_stick_s"]), volume * STICKS * PERIOD_S, 8)
            self.assertEqual(last.metadata["wobblebench_lost_sticks"], "0")
            self.assertEqual(last.metadata["wobblebench_source"], "simulated")
            self.assertGreater(float(last.metadata["wobblebench_age_newest_ms"]), 0)

    def test_the_volume_is_the_exported_one_and_lies_where_the_ball_is(self):
        file = self.path("ball.seq.nrrd")
        run("export", "sim", *SCENE, "--volumes", 3, "--to", file + ",spacing_mm=2,type=uint16")
        with open(file, "rb") as whole:
            header, body = whole.read().split(b"\n\n", 1)
        size = np.array(re.search(rb"\nsizes: (\d+) (\d+) (\d+) 3\n", header).groups(), int)
        origin = np.array(re.search(rb"\nspace origin: \((.*)\)", header)[1].split(b","), float)
        exported = np.frombuffer(body, "<u2").reshape(3, *size[::-1])
        for message in self.stream.of("Volume"):
            image = igtl.Image(message)
            np.testing.assert_array_equal(image.voxels, exported[int(message.metadata["wobblebench_volume"])])
        self.assertEqual(image.coordinates, 1)
        at = image.positions() * TO_RAS
        np.testing.assert_allclose(at[0, 0, 0], origin, atol=1e-3)
        np.testing.assert_allclose(at[-1, -1, -1], origin + 2 * (size - 1), atol=1e-3)
        # What echoes most lies on the ball's side to the probe.
        bright = at[image.voxels > 0.8 * image.voxels.max()]
        self.assertLess(np.linalg.norm(bright.mean(0)[:2] - BALL[:2]), 6)
        self.assertLess(abs(np.median(np.linalg.norm(bright - BALL, axis=-1)) - RADIUS), 6)

    def test_polar_samples_are_the_exported_ones(self):
        file = self.path("polar.npz")
        run("export", "sim", *SCENE, "--volumes", "3", "--to", file + ",content=polar")
        message = self.stream.of("Polar")[-1]
        voxels = igtl.Image(message).voxels
        self.assertEqual(voxels.shape, (21, 40, 192))
        self.assertEqual(message.metadata["wobblebench_content"], "polar")
        self.assertEqual(float(message.metadata["wobblebench_depth_mm"]), 160)
        np.testing.assert_allclose(voxels / 65535, np.load(file)["samples"][2], atol=1e-5)

    def test_the_surface_is_the_ball(self):
        for message in self.stream.of("Surface"):
            points, corners = igtl.surface(message)
            self.assertGreater(len(points), 2000)
            self.assertGreater(len(corners), 2000)
            self.assertLess(corners.max(), len(points))
            at = points * TO_RAS
            off = abs(np.linalg.norm(at - BALL, axis=-1) - RADIUS)
            self.assertLess(np.median(off), 0.6)
            self.assertLess(abs(at[:, 0].mean() - BALL[0]), 1)  # and is on its side
            self.assertLess(abs(at[:, 1].mean() - BALL[1]), 1)
            normals = np.cross(at[corners[:, 1]] - at[corners[:, 0]], at[corners[:, 2]] - at[corners[:, 0]])
            self.assertGreater((normals[:, 2] < 0).mean(), 0.95)  # to the viewer, who is at the probe

    def test_the_last_picture_is_that_of_the_folder_in_its_place(self):
        reader = vtkPNGReader()
        reader.SetFileName(os.path.join(self.stream.out, "surface.png"))
        reader.Update()
        png = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(160, 160, 3)[::-1]
        image = igtl.Image(self.stream.of("Picture")[-1])
        np.testing.assert_array_equal(image.voxels[0], png)
        # Where the picture shows the ball, a ray along its normal meets the ball.
        at = image.positions()[0] * TO_RAS
        lit = image.voxels[0].max(-1) > image.voxels[0].min() + 40
        self.assertGreater(lit.sum(), 500)
        self.assertLess((np.linalg.norm(at[lit][:, :2] - BALL[:2], axis=-1) > RADIUS + 2).mean(), 0.05)

    def test_poses_turn_the_plane_at_rest_into_the_frame(self):
        poses = self.stream.of("MotorToProbe")
        self.assertGreater(len(poses), 3)
        for message in poses:
            frame = int(message.metadata["wobblebench_frame"])
            phi = np.radians(-30.5 + 61 * frame / 20)
            at_rest = np.array([7.0, 0.0, 100.0])  # 40 mm of face, 27 mm to the axis
            expected = np.array([7.0, -(100 - 13) * np.sin(phi), 13 + (100 - 13) * np.cos(phi)])
            moved = igtl.transform(message) @ np.append(at_rest * TO_RAS, 1)
            np.testing.assert_allclose(moved[:3] * TO_RAS, expected, atol=1e-4)
            last = (int(message.metadata["wobblebench_volume"]) * 21 + frame + 1) * 40 - 1
            self.assertAlmostEqual(message.seconds, last * PERIOD_S, 8)

    def test_the_report_counts_what_each_client_got(self):
        sent = self.stream.report["timing"]["send"]
        self.assertEqual(len(sent["clients"]), 2)
        self.assertEqual(sorted(client["sent"] for client in sent["clients"]),
                         sorted(len(messages) for messages in self.stream.received))
        made = {kind["device"]: kind["made"] for kind in sent["messages"]}
        self.assertEqual(made["MotorToProbe"], 63)
        for client in sent["clients"]:
            # Each message that was made was sent, replaced or left; and two statuses.
            self.assertEqual(client["sent"] + client["replaced"] + client["left"], sum(made.values()) + 2)
        self.assertIn("2 clients", self.stream.output)


class Checksum(unittest.TestCase):
    def test_the_reader_s_own_is_the_published_one(self):
        self.assertEqual(igtl.crc64(b"123456789"), 0x6C40DF5F0B497347)  # of catalogues of CRCs


class Clients(InFolder):
    def test_one_that_does_not_read_and_one_that_leaves_hold_nothing_up(self):
        stream = Stream(self.folder, "igtl=0,spacing_mm=1,content=volume+picture", "--volumes", "8",
                        "--policy", "every", clients=(igtl.receive_all, never_reads, leaves))
        self.assertEqual(stream.report["timing"]["latency"]["shown"]["volumes"], 8)
        text = f"stream ends: 8 volumes shown, 0 of {8 * STICKS} sticks lost"
        self.assertEqual(igtl.status(stream.of("Wobblebench")[-1]), (1, text))
        for device in ("Picture", "Volume"):
            self.assertEqual(stream.of(device)[-1].metadata["wobblebench_volume"], "7")
        clients = {client["address"]: client for client in stream.report["timing"]["send"]["clients"]}
        reads, waits, left = (clients[address] for address in stream.addresses)
        self.assertEqual((reads["left"], reads["ending"]), (0, "connected to the end"))
        self.assertGreater(waits["replaced"] + waits["left"], 0)
        self.assertNotEqual(left["ending"], "connected to the end")

    def test_times_that_are_not_known_are_not_sent(self):
        file = self.path("scan.mha")
        run("export", "sim", *SCENE, "--to", file + ",content=polar")
        stream = Stream(self.folder, "igtl=0,content=volume+pose", "--board", "file=" + file)
        for device in ("Volume", "MotorToProbe"):
            message = stream.of(device)[-1]
            self.assertEqual(message.seconds, 0)
            self.assertNotIn("wobblebench_newest_stick_s", message.metadata)

    def test_positions_in_the_probe_frame_if_asked_for(self):
        stream = Stream(self.folder, "igtl=0,content=surface+volume,axes=lps", "--volumes", "2")
        points, _ = igtl.surface(stream.of("Surface")[-1])
        self.assertLess(np.median(abs(np.linalg.norm(points - BALL, axis=-1) - RADIUS)), 0.6)
        self.assertEqual(igtl.Image(stream.of("Volume")[-1]).coordinates, 2)

    def test_more_clients_than_allowed_are_sent_away(self):
        stream = Stream(self.folder, "igtl=0,content=pose,clients=1", "--volumes", "2",
                        clients=(igtl.receive_all, igtl.receive_all, igtl.receive_all))
        self.assertEqual(len(stream.report["timing"]["send"]["clients"]), 1)
        self.assertEqual(stream.report["timing"]["send"]["refused_clients"], 2)
        self.assertEqual(sorted(map(bool, stream.received)), [False, False, True])


def program(name):
    """A client of the library beside one that reads nothing; its lines are kept."""
    lines = []

    def receive(connection):
        port = connection.getpeername()[1]
        command = [os.environ[name], *(["127.0.0.1"] if name.endswith("CLIENT") else []), str(port)]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True,
                              timeout=600)
        lines.extend(done.stdout.splitlines())
        return iter(())
    return receive, lines


class Library(InFolder):
    """Clients on the library's own classes, which knows header version 1 alone."""

    @unittest.skipUnless("WOBBLEBENCH_IGTL_PEER" in os.environ, "built without libopenigtlink-dev")
    def test_it_reads_the_numbers_that_are_sent(self):
        receive, printed = program("WOBBLEBENCH_IGTL_PEER")
        stream = Stream(self.folder, "igtl=0,header=1,wait=3", "--volumes", "3", "--policy", "every",
                        clients=(igtl.receive_all, receive))
        lines = [line.split() for line in printed]
        self.assertEqual({words[0] for words in lines}, {"STATUS", "IMAGE", "POLYDATA", "TRANSFORM"}, printed[:5])
        last = {words[1]: words for words in lines}
        for device in ("Volume", "Picture"):
            message = stream.of(device)[-1]
            self.assertEqual((message.version, message.metadata), (1, {}))
            image, words = igtl.Image(message), last[device]
            np.testing.assert_allclose(float(words[2]), message.seconds, atol=1e-8)
            self.assertEqual([int(word) for word in words[3:6]], list(image.voxels.shape[2::-1]))
            np.testing.assert_allclose([float(word) for word in words[6:9]],
                                       np.linalg.norm(image.steps, axis=1), rtol=1e-5)
            np.testing.assert_allclose([float(word) for word in words[9:12]], image.center, atol=1e-4)
            self.assertEqual(int(words[12]), int(image.voxels.sum()))
        points, corners = igtl.surface(stream.of("Surface")[-1])
        words = last["Surface"]
        self.assertEqual([int(word) for word in words[3:5]], [len(points), len(corners)])
        np.testing.assert_allclose([float(word) for word in words[5:8]], points.mean(0, dtype=float), atol=1e-3)
        matrix = igtl.transform(stream.of("MotorToProbe")[-1])
        np.testing.assert_allclose([float(word) for word in last["MotorToProbe"][3:]], matrix[:3].ravel(), atol=1e-5)

    @unittest.skipUnless("WOBBLEBENCH_IGTL_RECEIVE_CLIENT" in os.environ, "built without openigtlink-examples")
    def test_its_example_reads_every_message(self):
        receive, printed = program("WOBBLEBENCH_IGTL_RECEIVE_CLIENT")
        stream = Stream(self.folder, "igtl=0,header=1,content=picture+volume+pose,wait=2", "--volumes", "2",
                        "--policy", "every", clients=(receive,))
        text = "\n".join(printed)
        client = max(stream.report["timing"]["send"]["clients"], key=lambda each: each["sent"])
        self.assertEqual(text.count("data type."), client["sent"])
        # It says more of an image whose CRC is right.
        self.assertEqual(text.count("Scalar Type           : 3"), text.count("Receiving IMAGE"))
        for part in ("Device Name           : Volume", "Dimensions            : (160, 160, 1)",
                     "Spacing               : (2, 2, 2)"):
            self.assertIn(part, text)


class Refusals(unittest.TestCase):
    def refuse(self, send, why):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "out")
            answer = run("stream", "--send", send, "--out", out, code=2)
            self.assertEqual(len(answer.strip().splitlines()), 1, answer)
            self.assertIn(f"--send = {send}: {why}", answer)
            self.assertFalse(os.path.exists(out))

    def test_bad_arguments(self):
        ports = "must be PORT or HOST:PORT, with a port from 0 to 65535"
        for send, why in (("", "must be igtl=PORT"), ("igtl", ports), ("igtl=", ports), ("igtl=70000", ports),
                          ("igtl=:18944", ports), ("igtl=x", ports), ("udp=1", "must be igtl=PORT"),
                          ("igtl=0,content=", "content = : must be of picture"),
                          ("igtl=0,content=pose+video", "content = pose+video: must be of picture"),
                          ("igtl=0,content=pose+pose", "content = pose+pose: must be of"),
                          ("igtl=0,content=pose,spacing_mm=2", "spacing_mm = 2: acts with content=volume"),
                          ("igtl=0,spacing_mm=0", "spacing_mm = 0: must be"),
                          ("igtl=0,clients=2,wait=3", "wait = 3: must be at most clients=2"),
                          ("igtl=0,type=float", "type = float: must be one of uint8, uint16"),
                          ("igtl=0,speed=1", "speed = 1: no such key; igtl takes content"),
                          ("igtl=203.0.113.1:18944", "cannot listen at 203.0.113.1:18944: Cannot assign")):
            if send:
                self.refuse(send, why)

    def test_a_port_that_is_taken(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.refuse(f"igtl={port}", f"cannot listen at 127.0.0.1:{port}: Address already in use")


if __name__ == "__main__":
    unittest.main()
