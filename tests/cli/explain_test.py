"""kadr explain, and that render reads nothing that a shot does not need."""

import json
import os
import struct
import zlib

import program
from program import ProgramTest


def png_bytes(width=2, height=1, level=128):
    """A grey PNG."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + bytes([level] * width) for _ in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


class ExplainTest(ProgramTest):
    def change_gltf(self, change):
        path = self.folder / "ball.gltf"
        gltf = json.loads(path.read_text())
        change(gltf)
        path.write_text(json.dumps(gltf))

    def add_images(self, *names):
        """A texture for each file; they are not there."""
        def change(gltf):
            gltf["images"] = [{"uri": name} for name in names]
            gltf["textures"] = [{"source": i} for i in range(len(names))]
        self.change_gltf(change)

    def explain(self, *arguments):
        return json.loads(self.run_kadr("explain", self.shot, "--device", "cpu", "--json", *arguments).out)

    def needs(self, *arguments):
        return {f"{entry['group']}: {entry['name']}": entry["first"] for entry in self.explain(*arguments)["needs"]}

    def peak_bytes(self, *arguments):
        """Peak memory of a run of the program."""
        process = self.start(*arguments)
        process.stdout.read(), process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stdout.close(), process.stderr.close()
        self.assertEqual(process.returncode, 0)
        return usage.ru_maxrss * 1024


class Explain(ExplainTest):
    def test_text_names_needs_reasons_and_kernels(self):
        text = self.run_kadr("explain", self.shot, "--device", "cpu").out
        self.assertIn("ball: 3 frames from 0 to 2, 48 x 32 pixels, 4 samples a pixel\n", text)
        for line in (r"needs\n  integrator    path +render\.integrator\n", r"  motion blur   instances +node 'ball/Ball'\n",
                     r"  materials     dielectric +material 'material 0'\n", r"  lights        point +light 'key'\n",
                     r"  environment   colour +environment\.color\n",
                     r"leaves out\n  nothing: all that the files hold is used\n", r"glTF extensions\n  none\n",
                     r"kernels\n  cpu \(Embree .*\): asked for by --device cpu\n  path with transforms: frames 0, 1, 2\n  robust rays: no: few would slip between triangles\n"):
            self.assertRegex(text, line)

    def test_json_has_the_same_facts(self):
        facts = self.explain()
        self.assertEqual(facts["frames"], {"count": 3, "first": 0, "last": 2})
        self.assertEqual(facts["needs"][0], {"group": "integrator", "name": "path", "first": "render.integrator", "count": 1, "askers": "settings"})
        self.assertEqual(facts["left_out"], [])
        self.assertEqual(facts["kernels"], [{"name": "transforms", "frames": [0, 1, 2]}])

    def test_frames_and_settings_decide(self):
        self.assertIn("motion blur: instances", self.needs())
        self.assertNotIn("motion blur: instances", self.needs("--set", "shutter.angle=0"))
        self.assertNotIn("integrator: path", self.needs("--set", "render.integrator=direct"))
        self.assertEqual(self.explain("--frames", "1")["frames"]["count"], 1)

    def test_cost_is_measured_where_it_is_asked_for(self):
        self.assertEqual(self.explain()["cost"], {"pixel_samples": 48 * 32 * 4})
        cost = self.explain("--measure", "--size", "320x200", "--samples", "9")["cost"]
        measured = cost["measured"]
        self.assertEqual([measured[key] for key in ("frame", "width", "height", "samples")], [1, 160, 100, 4])
        self.assertGreater(measured["rays_per_sample"], 0.9)
        self.assertAlmostEqual(measured["trace_s"], cost["pixel_samples"] / measured["pixel_samples_per_s"])
        self.assertIn("its time was not measured", self.run_kadr("explain", self.shot).out)
        self.assertRegex(self.run_kadr("explain", self.shot, "--measure").out, r"s to trace, and .* s to set up the first: by frame 1 at 48 x 32 with 4 samples a pixel")

    def test_memory_is_told_by_part(self):
        memory = self.explain()["memory"]
        self.assertEqual([part["name"] for part in memory["parts"]][:2], ["program", "geometry"])
        self.assertEqual(sum(part["bytes"] for part in memory["parts"]) // 1000, memory["bytes"] // 1000)
        self.assertRegex(self.run_kadr("explain", self.shot).out, r"memory on the CPU: about \d+ MiB at the most, when .*\n  program +\d+\.\d MiB  with its libraries")

    def test_extensions_are_followed_or_ignored(self):
        self.change_gltf(lambda gltf: gltf.update(extensionsUsed=["KHR_materials_unlit", "KHR_materials_sheen"]))
        facts = self.explain()
        self.assertEqual(facts["extensions"], [{"scene": "ball", "followed": ["KHR_materials_unlit"], "ignored": ["KHR_materials_sheen"]}])
        self.assertIn("names KHR_materials_sheen, which is not supported", facts["warnings"][0])
        self.assertIn("  ball          follows KHR_materials_unlit\n                ignores KHR_materials_sheen\n",
                      self.run_kadr("explain", self.shot).out)

    def test_writes_nothing(self):
        before = sorted(self.folder.rglob("*"))
        self.explain()
        self.assertEqual(sorted(path for path in self.folder.rglob("*") if "cache" not in path.parts), before)

    def test_errors_are_those_of_check(self):
        bad = self.write_shot(name="bad.yaml", more="  vidoe: a.mp4\n")
        self.assertEqual(self.run_kadr("explain", bad, code=2).err, self.run_kadr("check", bad, code=2).err)

    def test_reels_are_refused(self):
        (self.folder / "reel.yaml").write_text("kadr-reel: 1\nshots:\n  - { shot: ball.yaml }\n")
        self.assertIn("reel.yaml is a reel\n  expected a shot", self.run_kadr("explain", "reel.yaml", code=2).err)


class Unneeded(ExplainTest):
    """What a shot does not need may be missing, damaged or huge: render does not look at it, check does."""

    def left_out(self):
        return {(one["kind"], one["name"]): one["why"] for one in self.explain()["left_out"]}

    def test_image_of_occlusion(self):
        self.add_images("shade.png")
        self.change_gltf(lambda gltf: gltf["materials"][0].update(occlusionTexture={"index": 0}))
        self.run_kadr("render", self.shot)
        self.assertIn("baked occlusion", self.left_out()["image", "ball/shade.png"])
        self.assertIn("there is no such file", self.run_kadr("check", self.shot, code=2).err)

    def test_images_of_what_is_hidden_or_outside_or_never_worn(self):
        self.add_images("hidden.png", "outside.png", "variant.png", "spare.png")

        def change(gltf):
            def textured(i):
                return {"name": f"m{i}", "pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}
            gltf["materials"] += [textured(i) for i in range(3)]
            primitive = gltf["meshes"][0]["primitives"][0]
            gltf["meshes"] += [{"primitives": [{**primitive, "material": 1}]}, {"primitives": [{**primitive, "material": 2}]}]
            gltf["nodes"] += [{"name": "Hidden", "mesh": 1}, {"name": "Outside", "mesh": 2}]
            gltf["scenes"][0]["nodes"] = [0, 1]
            gltf["extensionsUsed"] = ["KHR_materials_variants"]
            gltf["extensions"] = {"KHR_materials_variants": {"variants": [{"name": "worn"}, {"name": "other"}]}}
            primitive["extensions"] = {"KHR_materials_variants": {"mappings": [{"material": 3, "variants": [1]}]}}
        self.change_gltf(change)
        self.shot.write_text(self.shot.read_text().replace("gltf: ball.gltf,", "gltf: ball.gltf, hide: [Hidden], variant: worn,"))
        self.run_kadr("render", self.shot)
        left_out = self.left_out()
        for name in ("hidden.png", "outside.png", "variant.png"):
            self.assertEqual(left_out["image", f"ball/{name}"], "its materials are on nothing that is shown")
        self.assertEqual(left_out["image", "ball/spare.png"], "no material of a mesh names it")
        self.assertEqual(left_out["node", "ball/Hidden"], "hide leaves it out")
        self.assertEqual(left_out["node", "ball/Outside"], "it is not in the file's default scene")
        self.run_kadr("check", self.shot, code=2)
        self.shot.write_text(self.shot.read_text().replace("variant: worn", "variant: other"))
        self.assertIn("variant.png", self.run_kadr("render", self.shot, code=2).err)

    def test_image_that_is_a_pipe(self):
        self.add_images("pipe.png")
        self.change_gltf(lambda gltf: gltf["materials"][0].update(occlusionTexture={"index": 0}))
        os.mkfifo(self.folder / "pipe.png")
        self.run_kadr("render", self.shot)

    def test_image_of_gigabytes_costs_no_memory(self):
        plain = self.peak_bytes("render", self.shot, "--threads", "2")
        self.add_images("huge.png")
        self.change_gltf(lambda gltf: gltf["materials"][0].update(occlusionTexture={"index": 0}))
        with open(self.folder / "huge.png", "wb") as file:
            file.write(png_bytes())
            file.truncate(3 << 30)
        self.assertLess(self.peak_bytes("render", self.shot, "--threads", "2", "--overwrite"), plain + (64 << 20))

    def test_image_of_gigabytes_inside_a_glb_file_costs_no_memory(self):
        plain = self.peak_bytes("render", self.shot, "--threads", "2")
        gltf = json.loads((self.folder / "ball.gltf").read_text())
        size = 3 << 30
        gltf["buffers"].insert(0, {"byteLength": size})
        for view in gltf["bufferViews"]:
            view["buffer"] = 1
        gltf["bufferViews"].append({"buffer": 0, "byteLength": size})
        gltf["images"] = [{"bufferView": 2, "mimeType": "image/png"}]
        text = json.dumps(gltf).encode()
        text += b" " * (-len(text) % 4)
        with open(self.folder / "ball.glb", "wb") as file:
            file.write(b"glTF" + struct.pack("<II", 2, 20 + len(text) + 8 + size) + struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", size, b"BIN\0"))
            file.truncate(20 + len(text) + 8 + size)
        self.shot.write_text(self.shot.read_text().replace("ball.gltf", "ball.glb"))
        self.assertLess(self.peak_bytes("render", self.shot, "--threads", "2", "--overwrite"), plain + (64 << 20))

    def test_clip_that_nothing_plays(self):
        def change(gltf):
            gltf["animations"] = [{"name": name, "samplers": [{"input": 0, "output": 0}],
                                   "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]} for name in ("Run",)]
        self.change_gltf(change)
        self.assertIn("/animations/0", self.run_kadr("render", self.shot, code=2).err)
        self.shot.write_text(self.shot.read_text().replace("gltf: ball.gltf,", "gltf: ball.gltf, animation: { clip: none },"))
        self.run_kadr("render", self.shot)
        self.assertEqual(self.left_out()["clip", "ball/Run"], "no layer plays it")

    def test_frames_stay_complete_when_what_is_not_needed_changes(self):
        self.add_images("shade.png")
        self.change_gltf(lambda gltf: gltf["materials"][0].update(occlusionTexture={"index": 0}))
        self.run_kadr("render", self.shot)
        (self.folder / "shade.png").write_bytes(png_bytes())
        self.assertEqual(self.run_kadr("render", self.shot, "--json").out.count('"reused":true'), 3)


if __name__ == "__main__":
    program.main()
