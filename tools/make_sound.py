#!/usr/bin/env python3
"""Makes shots/assets/reel.wav, the sound under the sample reel: six seconds that begin again without a seam.

    tools/make_sound.py            writes the file
    tools/make_sound.py --check    compares the file with what would be written

Four chords of a plucked string over a soft bass, synthesised from sines; the same on every machine but for the last bit.
The sound is part of this work and under its licence.
"""
import pathlib
import sys
import wave

import numpy

RATE = 22050
BEAT_S = 0.375
CHORDS = [("A2", "E3 A3 C4 E4"), ("F2", "C3 A3 C4 G4"), ("C3", "G3 C4 E4 B4"), ("G2", "D3 B3 D4 A4")]
BEATS_A_CHORD = 4
FILE = pathlib.Path(__file__).resolve().parent.parent / "shots" / "assets" / "reel.wav"


def frequency(note):
    """Equal temperament, A4 = 440 Hz."""
    semitones = {"C": -9, "D": -7, "E": -5, "F": -4, "G": -2, "A": 0, "B": 2}[note[0]] + 12 * (int(note[1]) - 4)
    return 440 * 2 ** (semitones / 12)


def pluck(note, seconds, softness):
    """A string: partials that fade the faster the higher they are."""
    t = numpy.arange(int(seconds * RATE)) / RATE
    sound = sum(numpy.sin(2 * numpy.pi * frequency(note) * k * t) * numpy.exp(-t * k * 2.2) / k ** softness for k in range(1, 9))
    return sound * numpy.minimum(t / 0.004, 1)


def bass(note, seconds):
    t = numpy.arange(int(seconds * RATE)) / RATE
    swell = numpy.sin(numpy.pi * numpy.minimum(t / seconds, 1)) ** 0.7
    return (numpy.sin(2 * numpy.pi * frequency(note) * t) + 0.3 * numpy.sin(4 * numpy.pi * frequency(note) * t)) * swell


def add(track, at_s, sound, gain):
    """What rings on after the end is heard at the beginning: the loop has no seam."""
    at = (int(at_s * RATE) + numpy.arange(len(sound))) % len(track)
    numpy.add.at(track, at, sound * gain)


def loop():
    track = numpy.zeros(int(len(CHORDS) * BEATS_A_CHORD * BEAT_S * RATE))
    for number, (root, notes) in enumerate(CHORDS):
        begin = number * BEATS_A_CHORD * BEAT_S
        add(track, begin, bass(root, BEATS_A_CHORD * BEAT_S * 1.15), 0.30)
        rising = notes.split()
        for step, note in enumerate(rising + [rising[2], rising[3], rising[1], rising[2]]):
            add(track, begin + step * BEAT_S / 2, pluck(note, 2.0, 1.6), 0.26 if step % 2 == 0 else 0.17)
    return numpy.round(track / numpy.abs(track).max() * 0.6 * 32767).astype("<i2")


def main():
    samples = loop()
    if "--check" in sys.argv[1:]:
        with wave.open(str(FILE)) as file:
            found = numpy.frombuffer(file.readframes(file.getnframes()), "<i2")
        # One step of 16 bits: another machine's sine may differ in its last bit.
        same = len(found) == len(samples) and numpy.abs(found.astype(int) - samples).max() <= 1
        print("reel.wav is as the script makes it" if same else "reel.wav differs; run tools/make_sound.py and commit the file")
        sys.exit(0 if same else 1)
    with wave.open(str(FILE), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes(samples.tobytes())
    print(f"{FILE}: {FILE.stat().st_size} bytes, {len(samples) / RATE:.2f} s")


if __name__ == "__main__":
    main()
