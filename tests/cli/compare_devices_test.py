"""`kadr compare-devices` from outside: what it prints and writes, and its exit codes."""

import json

import program
from program import ProgramTest

SMALL = ("--samples", "4", "--replicates", "4")


class CompareDevices(ProgramTest):
    def test_the_processor_is_the_same_at_every_width(self):
        out = self.run_kadr("compare-devices", self.shot, "--devices", "cpu,cpu:1", *SMALL).out
        for line in (r"(?m)^frame 0$", r"(?m)^frame 1$", r"(?m)^frame 2$", r"(?m)^  rays     ok ", r"(?m)^  pixels   ok .*\|z\| > 2, 3, 4: [0-9.]+% \(4\.550%\)",
                     r"(?m)^  tiles    ok ", r"(?m)^  picture  ok ", r"(?m)^  mean     cpu:1 [+-][0-9.]+% of cpu, 95% interval ",
                     r"(?m)^  pictures FLIP [0-9.]+, relMSE .*; noise alone ", r"(?m)^  cpu:1    load .* million rays/s$",
                     r"(?m)^cpu and cpu:1 show the same: in 3 frames no ray contradicts"):
            self.assertRegex(out, line)

    def test_the_report_as_json(self):
        out = self.run_kadr("compare-devices", self.shot, "--devices", "cpu:1,exact", "--frames", "1", "--size", "24x16", "--output", "parity", "--json", *SMALL).out
        said = json.loads(out)
        self.assertEqual((said["differs"], said["size"], said["samples"], said["replicates"]), (False, [24, 16], 4, 4))
        self.assertEqual([device["name"] for device in said["devices"]], ["cpu:1", "exact"])
        self.assertEqual(said["frames"][0]["rays"]["rays"], 3 * 24 * 16)
        self.assertEqual(self.frames("parity/*"), ["ball.0001.cpu-1.exr", "ball.0001.exact.exr", "ball.0001.flip.png", "ball.0001.z.png", "ball.devices.json"])
        self.assertEqual(json.loads((self.folder / "parity/ball.devices.json").read_text()), said)

    def refused(self, *arguments):
        return self.run_kadr("compare-devices", self.shot, *arguments, code=2).err

    def test_bad_input(self):
        names = "expected two of cpu, cpu:1, cpu:8, hiprt, hiprt:N and exact, as in --devices cpu,hiprt"
        self.assertIn(f"error: --devices is 'cpu,gpu'\n  {names}", self.refused("--devices", "cpu,gpu"))
        self.assertIn("error: --samples is 1\n  expected at least 2", self.refused("--devices", "cpu,cpu:1", "--samples", "1"))
        self.assertIn("error: --replicates is 2\n  expected a whole number of at least 3", self.refused("--devices", "cpu,cpu:1", "--replicates", "2"))

    def test_a_missing_gpu_is_said_to_be_missing_and_why(self):
        devices = [json.loads(line) for line in self.run_kadr("devices", "--json").out.splitlines()]
        gpu = next(device for device in devices if device["name"] == "hiprt")
        if gpu["usable"]:
            self.skipTest("this machine has a GPU that works")
        self.assertIn(f"error: --devices: hiprt: {gpu['reason']}\n  expected two devices that work here, as in --devices cpu,cpu:1; see kadr devices", self.refused())


if __name__ == "__main__":
    program.main()
