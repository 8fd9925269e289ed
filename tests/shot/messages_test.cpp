// Every message a shot file can earn, literally: they are read by people, and a change of one is a change for users.
#include <fmt/format.h>

#include <gmock/gmock.h>

#include <vector>

#include "shot/shot_fixture.h"

namespace kadr {
namespace {

using Messages = ShotTest;

struct Case {
    std::string text, message;
};

TEST_F(Messages, AreLiterally) {
    const std::vector<Case> cases{
        {std::string(R"()"),
         R"(shot.yaml: error: the file is empty
  expected a shot, at least: kadr: 1, scenes: [ { gltf: model.glb } ], camera: { position: [0, 1, 5] })"},
        {std::string("# only a comment\n"),
         R"(shot.yaml: error: the file is empty
  expected a shot, at least: kadr: 1, scenes: [ { gltf: model.glb } ], camera: { position: [0, 1, 5] })"},
        {std::string(R"(just text)"),
         R"(shot.yaml:1:1: error: the file is 'just text'
    just text
    ^~~~~~~~~
  expected a shot, at least: kadr: 1, scenes: [ { gltf: model.glb } ], camera: { position: [0, 1, 5] })"},
        {std::string(R"([1, 2])"),
         R"(shot.yaml:1:1: error: the file is a list of 2
    [1, 2]
    ^~~~~~
  expected a shot, at least: kadr: 1, scenes: [ { gltf: model.glb } ], camera: { position: [0, 1, 5] })"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ])"),
         R"(shot.yaml:1:1: error: camera is missing
    kadr: 1
    ^
  add `camera: { position: [3, 1.4, 4], look_at: helmet, focal_length: 35 mm }`)"},
        {std::string(R"(kadr: 2
scenes: [ a.glb ]
camera: {})"),
         R"(shot.yaml:1:7: error: the shot is written in format version 2
    kadr: 2
          ^
  expected kadr: 1; this Kadr reads version 1)"},
        {std::string(kBase) + R"(---
kadr: 1)",
         R"(shot.yaml:4:1: error: a second document starts here
    ---
    ^
  expected one shot a file; remove '---' and what follows)"},
        {std::string("kadr: [1\n"),
         R"(shot.yaml:2:1: error: this is not valid YAML: end of sequence flow not found
  expected `key: value` lines; check brackets, quotes and indentation (spaces, no tabs))"},
        {std::string(R"(kadr: 1
	name: a)"),
         R"(shot.yaml:2:1: error: this is not valid YAML: illegal tab when looking for indentation
    	name: a
    ^
  expected `key: value` lines; check brackets, quotes and indentation (spaces, no tabs))"},
        {std::string(R"(kadr-reel: 1
shots: [])"),
         R"(shot.yaml:1:12: error: this is a reel (kadr-reel), not a shot
    kadr-reel: 1
               ^
  expected a shot file here; `kadr render` and `kadr check` take reels, too)"},
        {std::string(kBase) + R"(name: a/b)",
         R"(shot.yaml:4:7: error: name is 'a/b'
    name: a/b
          ^~~
  expected a name that can be part of a file name: no '/', braces or line breaks, at most 100 bytes)"},
        {std::string(kBase) + R"(rendr: {})",
         R"(shot.yaml:4:1: error: unknown key 'rendr'
    rendr: {}
    ^~~~~
  did you mean 'render'?)"},
        {std::string(kBase) + R"(render: { sampels: 4 })",
         R"(shot.yaml:4:11: error: unknown key 'sampels' in render
    render: { sampels: 4 }
              ^~~~~~~
  did you mean 'samples'?)"},
        {std::string(kBase) + R"(render: { colour: 4 })",
         R"(shot.yaml:4:11: error: unknown key 'colour' in render
    render: { colour: 4 }
              ^~~~~~
  expected one of quality, integrator, samples, bounces, filter, motion_tolerance, motion_frames, clamp, denoise, build, robust, texture_limit, fresnel, seed, cull_backfaces)"},
        {std::string(kBase) + R"(image: { size: [1, 2] }
image: { size: [3, 4] })",
         R"(shot.yaml:5:1: error: duplicate key 'image'
    image: { size: [3, 4] }
    ^~~~~
  it is already given at line 4; keep one of the two)"},
        {std::string(kBase) + R"(render: { samples: many })",
         R"(shot.yaml:4:20: error: render.samples is 'many'
    render: { samples: many }
                       ^~~~
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot)"},
        {std::string(kBase) + R"(render: { samples: 0 })",
         R"(shot.yaml:4:20: error: render.samples is 0
    render: { samples: 0 }
                       ^
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot)"},
        {std::string(kBase) + R"(render: { samples: 1.5 })",
         R"(shot.yaml:4:20: error: render.samples is 1.5
    render: { samples: 1.5 }
                       ^~~
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot)"},
        {std::string(kBase) + R"(render: { samples: [1] })",
         R"(shot.yaml:4:20: error: render.samples is a list of 1
    render: { samples: [1] }
                       ^~~
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot)"},
        {std::string(kBase) + R"(render: 5)",
         R"(shot.yaml:4:9: error: render is 5
    render: 5
            ^
  expected a map of quality, integrator, samples, bounces, filter, motion_tolerance, motion_frames, clamp, denoise, build, robust, texture_limit, fresnel, seed, cull_backfaces)"},
        {std::string(kBase) + R"(render: { samples: { max_error: 2, at_least: 64, at_most: 32 } })",
         R"(shot.yaml:4:33: error: render.samples.max_error is 2
    render: { samples: { max_error: 2, at_least: 64, at_most: 32 } }
                                    ^
  expected 1e-06 to 1
shot.yaml:4:46: error: render.samples.at_least is 64 and at_most 32
    render: { samples: { max_error: 2, at_least: 64, at_most: 32 } }
                                                 ^~
  expected at_least to be no more than at_most)"},
        {std::string(kBase) + R"(render: { motion_frames: 1 })",
         R"(shot.yaml:4:26: error: render.motion_frames is 1
    render: { motion_frames: 1 }
                             ^
  expected a whole number from 2 to 129 or auto or a map of count, mix)"},
        {std::string(kBase) + R"(render: { motion_frames: { count: 130, mix: lerp } })",
         R"(shot.yaml:4:35: error: render.motion_frames.count is 130
    render: { motion_frames: { count: 130, mix: lerp } }
                                      ^~~
  expected a whole number from 2 to 129
shot.yaml:4:45: error: render.motion_frames.mix is 'lerp'
    render: { motion_frames: { count: 130, mix: lerp } }
                                                ^~~~
  expected one of srt, matrix)"},
        {std::string(kBase) + R"(render: { motion_frames: { mix: matrix } })",
         R"(shot.yaml:4:26: error: render.motion_frames.count is missing
    render: { motion_frames: { mix: matrix } }
                             ^~~~~~~~~~~~~~~
  add `count: 5`)"},
        {std::string(kBase) + R"(render: { samples: { at_most: 32 } })",
         R"(shot.yaml:4:20: error: render.samples has neither max_error nor time_budget
    render: { samples: { at_most: 32 } }
                       ^~~~~~~~~~~~~~~
  expected { max_error: 0.01 }, { time_budget: 20 s } or both; a plain number gives every pixel as many samples)"},
        {std::string(kBase) + R"(render: { samples: { time_budget: 20, at_mots: 5 } })",
         R"(shot.yaml:4:39: error: unknown key 'at_mots' in render.samples
    render: { samples: { time_budget: 20, at_mots: 5 } }
                                          ^~~~~~~
  did you mean 'at_most'?)"},
        {std::string(kBase) + R"(shutter: { angle: 540 deg })",
         R"(shot.yaml:4:19: error: shutter.angle is 540 deg
    shutter: { angle: 540 deg }
                      ^~~~~~~
  expected 0 to 360 deg; use 360 deg to keep the shutter open for the whole frame)"},
        {std::string(kBase) + R"(shutter: { angle: .nan })",
         R"(shot.yaml:4:19: error: shutter.angle is .nan
    shutter: { angle: .nan }
                      ^~~~
  expected 0 to 360 deg; infinite numbers and NaN are not allowed)"},
        {std::string(kBase) + R"(shutter: { angle: .inf })",
         R"(shot.yaml:4:19: error: shutter.angle is .inf
    shutter: { angle: .inf }
                      ^~~~
  expected 0 to 360 deg; infinite numbers and NaN are not allowed)"},
        {std::string(kBase) + R"(shutter: { angle: 1e400 })",
         R"(shot.yaml:4:19: error: shutter.angle is 1e400
    shutter: { angle: 1e400 }
                      ^~~~~
  expected 0 to 360 deg; the number is too large or too small to be represented)"},
        {std::string(kBase) + R"(shutter: { angle: 0x10 })",
         R"(shot.yaml:4:19: error: shutter.angle is 0x10
    shutter: { angle: 0x10 }
                      ^~~~
  expected 0 to 360 deg; use 360 deg to keep the shutter open for the whole frame)"},
        {std::string(kBase) + R"(shutter: { angle: "90" })",
         R"(shot.yaml:4:19: error: shutter.angle is '90'
    shutter: { angle: "90" }
                      ^~~~
  expected 0 to 360 deg; remove the quotes)"},
        {std::string(kBase) + R"(shutter: { angle: 2 s })",
         R"(shot.yaml:4:19: error: shutter.angle is 2 s
    shutter: { angle: 2 s }
                      ^~~
  expected 0 to 360 deg; 's' is not one of its units (deg, rad))"},
        {std::string(kBase) + R"(shutter: 180)",
         R"(shot.yaml:4:10: error: shutter is 180
    shutter: 180
             ^~~
  expected a map of angle, time, phase, open, close, curve, exposure, rolling; a bare shutter can only be 0, for no motion blur)"},
        {std::string(kBase) + R"(shutter: { open: 0.5, close: 0.25 })",
         R"(shot.yaml:4:30: error: shutter.close is 0.25, before shutter.open at 0.5
    shutter: { open: 0.5, close: 0.25 }
                                 ^~~~
  expected a close that is not before open)"},
        {std::string(kBase) + R"(shutter: { open: 0.5 })",
         R"(shot.yaml:4:18: error: shutter.open stands alone
    shutter: { open: 0.5 }
                     ^~~
  give both open and close, in frames: shutter: { open: -0.25, close: 0.25 })"},
        {std::string(kBase) + R"(shutter: { angle: 10, open: 0, close: 1 })",
         R"(shot.yaml:4:23: error: shutter.angle and shutter.open exclude each other
    shutter: { angle: 10, open: 0, close: 1 }
                          ^~~~
  remove one of the two
shot.yaml:4:32: error: shutter.angle and shutter.close exclude each other
    shutter: { angle: 10, open: 0, close: 1 }
                                   ^~~~~
  remove one of the two)"},
        {std::string(kBase) + R"(shutter: { phase: center })",
         R"(shot.yaml:4:19: error: shutter.phase is 'center'
    shutter: { phase: center }
                      ^~~~~~
  expected one of start, centre, end; did you mean 'centre'?)"},
        {std::string(kBase) + R"(timing: { frames: 9-5 })",
         R"(shot.yaml:4:19: error: timing.frames is 9-5: '9-5' runs backwards; write 5-9
    timing: { frames: 9-5 }
                      ^~~
  expected frames as "0-95", "0-95x2" (every second one) or "5,9,12-20")"},
        {std::string(kBase) + R"(timing: { fps: 24, frames: 5,9,12-20 })",
         R"(shot.yaml:4:28: error: timing.frames is cut short: YAML reads 5 alone
    timing: { fps: 24, frames: 5,9,12-20 }
                               ^
  inside braces a comma begins the next key; quote the list: frames: "5,9,12-20")"},
        {std::string(kBase) + R"(timing: { fps: 0 })",
         R"(shot.yaml:4:16: error: timing.fps is 0
    timing: { fps: 0 }
                   ^
  expected frames a second, such as 24, 23.976 or 24000/1001)"},
        {std::string(kBase) + R"(timing: { fps: 24000/0 })",
         R"(shot.yaml:4:16: error: timing.fps is 24000/0
    timing: { fps: 24000/0 }
                   ^~~~~~~
  expected frames a second, such as 24, 23.976 or 24000/1001)"},
        {std::string(kBase) + R"(timing: { frames: "" })",
         R"(shot.yaml:4:19: error: timing.frames is empty
    timing: { frames: "" }
                      ^~
  expected frames as "0-95", "0-95x2" (every second one) or "5,9,12-20")"},
        {std::string(kBase) + R"(timing: { frames: {} })",
         R"(shot.yaml:4:19: error: timing.frames is an empty map
    timing: { frames: {} }
                      ^~
  expected frames such as 0-95, 0-95x2 or "5,9,12-20")"},
        {std::string(kBase) + R"(image: { size: 1280x720 })",
         R"(shot.yaml:4:16: error: image.size is 1280x720
    image: { size: 1280x720 }
                   ^~~~~~~~
  expected [width, height], whole numbers from 1 to 65536)"},
        {std::string(kBase) + R"(image: { size: [0, 720] })",
         R"(shot.yaml:4:17: error: image.size[0] is 0
    image: { size: [0, 720] }
                    ^
  expected [width, height], whole numbers from 1 to 65536)"},
        {std::string(kBase) + R"(image: { crop: [0, 0, 10, 10] })",
         R"(shot.yaml:4:16: error: image.crop other than none is not supported yet
    image: { crop: [0, 0, 10, 10] }
                   ^~~~~~~~~~~~~~
  expected none)"},
        {std::string(R"(kadr: 1
scenes: []
camera: {})"),
         R"(shot.yaml:2:9: error: scenes is an empty list
    scenes: []
            ^~
  expected a list of maps; for example scenes: [ { gltf: assets/helmet.glb } ])"},
        {std::string(R"(kadr: 1
scenes: [ shot.yaml ]
camera: {})"),
         R"(shot.yaml:2:11: error: scenes.0 is 'shot.yaml'
    scenes: [ shot.yaml ]
              ^~~~~~~~~
  expected a file that ends in .gltf or .glb)"},
        {std::string(R"(kadr: 1
scenes: [ {id: x} ]
camera: {})"),
         R"(shot.yaml:2:11: error: scenes.x.gltf is missing
    scenes: [ {id: x} ]
              ^~~~~~~
  add `gltf: assets/helmet.glb`)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb, a.glb ]
camera: {})"),
         R"(shot.yaml:2:18: error: two scenes have the id 'a'
    scenes: [ a.glb, a.glb ]
                     ^~~~~
  give each scene an id of its own)"},
        {std::string(R"(kadr: 1
scenes: [ { id: a/b, gltf: a.glb } ]
camera: {})"),
         R"(shot.yaml:2:17: error: scenes.a/b.id is 'a/b'
    scenes: [ { id: a/b, gltf: a.glb } ]
                    ^~~
  expected a name without '/', which separates a scene from its nodes)"},
        {std::string(R"(kadr: 1
scenes:
  - { gltf: a.glb, transform: { scale: [1, 0, 1] } }
camera: {})"),
         R"(shot.yaml:3:40: error: scenes.0.transform.scale is zero
      - { gltf: a.glb, transform: { scale: [1, 0, 1] } }
                                           ^~~~~~~~~
  expected a scale that is not zero; a tiny one such as 1e-6 makes things vanish)"},
        {std::string(R"(kadr: 1
scenes:
  - gltf: a.glb
    transform: { scale: { keys: { 0 s: 1, 1 s: 0 } } }
camera: {})"),
         R"(shot.yaml:4:48: error: scenes.0.transform.scale is zero
        transform: { scale: { keys: { 0 s: 1, 1 s: 0 } } }
                                                   ^
  expected a scale that is not zero; a tiny one such as 1e-6 makes things vanish)"},
        {std::string(R"(kadr: 1
scenes:
  - gltf: a.glb
    transform: { rotate: { keys: { 0 s: [0, 0, 0], 2 s: [0, 180 deg, 0] } } }
camera: {})"),
         R"(shot.yaml:4:52: error: keys 0 s and 2 s of scenes.0.transform.rotate are 180 deg apart
        transform: { rotate: { keys: { 0 s: [0, 0, 0], 2 s: [0, 180 deg, 0] } } }
                                                       ^~~
  the way round is undefined; say it at the first, 0 s: { value: ..., axis: [x, y, z] }, or add a key between them)"},
        {std::string(R"(kadr: 1
scenes:
  - gltf: a.glb
    animation: { loop: repeat, clip: [ { A: 1 } ] }
camera: {})"),
         R"(shot.yaml:4:38: error: scenes.0.animation.clip is a list of 1
        animation: { loop: repeat, clip: [ { A: 1 } ] }
                                         ^~~~~~~~~~~~
  expected a whole number or a text or one of all, none or a map of names to weights such as { Walk: 0.3, Run: 0.7 }; a mix of clips is a map, or a list of layers right under animation)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { gltf: a/Cam, position: [0, 0, 0] })"),
         R"(shot.yaml:3:24: error: camera.gltf and camera.position exclude each other
    camera: { gltf: a/Cam, position: [0, 0, 0] }
                           ^~~~~~~~
  remove one of the two)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { focal_length: 35 mm, vertical_fov: 40 deg })"),
         R"(shot.yaml:3:32: error: camera.focal_length and camera.vertical_fov exclude each other
    camera: { focal_length: 35 mm, vertical_fov: 40 deg }
                                   ^~~~~~~~~~~~
  remove one of the two)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { focal_length: 35 s })"),
         R"(shot.yaml:3:25: error: camera.focal_length is 35 s
    camera: { focal_length: 35 s }
                            ^~~~
  expected 1 to 10000 mm; 's' is not one of its units (mm, cm, m))"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { position: [0, 1] })"),
         R"(shot.yaml:3:21: error: camera.position is a list of 2
    camera: { position: [0, 1] }
                        ^~~~~~
  expected [x, y, z])"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { position: { keys: { 0 s: [0, 0, 0], 0.0: [1, 1, 1] } } })"),
         R"(shot.yaml:3:47: error: two keys of camera.position are at the same time, 0 s and 0.0
    camera: { position: { keys: { 0 s: [0, 0, 0], 0.0: [1, 1, 1] } } }
                                                  ^~~
  expected one key a time)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { position: { keys: { 0 s: [0, 0, 0], soon: [1, 1, 1] }, interpolate: cubic, after: repeat } })"),
         R"(shot.yaml:3:47: error: the time of a key of camera.position is 'soon'
    camera: { position: { keys: { 0 s: [0, 0, 0], soon: [1, 1, 1] }, interpolate: cubic, after: repeat } }
                                                  ^~~~
  expected a time such as 2.5 s, 80 ms, 12 f or a number of seconds)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { position: { keys: {} } })"),
         R"(shot.yaml:3:29: error: camera.position.keys is an empty map
    camera: { position: { keys: {} } }
                                ^~
  expected a map of times to values such as { 0 s: 1, 24 f: 2 })"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { f_stop: { keys: { 0: { value: 1, ease: bounce }, 1: { value: 2, ease: [2, 0, 0, 0] }, 2: { ease: in } } } })"),
         R"(shot.yaml:3:50: error: camera.f_stop.keys.0.ease is 'bounce'
    camera: { f_stop: { keys: { 0: { value: 1, ease: bounce }, 1: { value: 2, ease: [2, 0, 0, 0] }, 2: { ease: in } } } }
                                                     ^~~~~~
  expected one of in, out, in-out
shot.yaml:3:81: error: camera.f_stop.keys.1.ease is a list of 4
    camera: { f_stop: { keys: { 0: { value: 1, ease: bounce }, 1: { value: 2, ease: [2, 0, 0, 0] }, 2: { ease: in } } } }
                                                                                    ^~~~~~~~~~~~
  expected four numbers [x1, y1, x2, y2] with x1 and x2 from 0 to 1
shot.yaml:3:100: error: camera.f_stop.keys.2.value is missing
    camera: { f_stop: { keys: { 0: { value: 1, ease: bounce }, 1: { value: 2, ease: [2, 0, 0, 0] }, 2: { ease: in } } } }
                                                                                                       ^~~~~~~~~~~~
  add `value: 2`)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 })"),
         R"(shot.yaml:3:15: error: camera.up is zero
    camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 }
                  ^~~~~~~~~
  expected a direction, a vector of any length but zero
shot.yaml:3:34: error: camera.blades is 2
    camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 }
                                     ^
  expected 0 for a round aperture, or 3 to 32
shot.yaml:3:44: error: camera.orbit.radius is missing
    camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 }
                                               ^~
  add `radius: 4 m`
shot.yaml:3:44: error: camera.orbit.to is missing
    camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 }
                                               ^~
  add `to: 4 s`, when the end is reached; or give turns as a track
shot.yaml:3:57: error: camera.look_at is '/x'
    camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 }
                                                            ^~
  expected [x, y, z] or a node such as scene/Node
shot.yaml:3:68: error: camera.focus is -1
    camera: { up: [0, 0, 0], blades: 2, orbit: {}, look_at: /x, focus: -1 }
                                                                       ^~
  expected more than 0 m or a node such as scene/Node)"},
        {std::string(kBase) + R"(lights: [ { id: a, type: sun } ])",
         R"(shot.yaml:4:26: error: lights.a.type is 'sun'
    lights: [ { id: a, type: sun } ]
                             ^~~
  expected one of directional, point, spot, area)"},
        {std::string(kBase) + R"(lights: [ { id: a, type: point, luminance: 3 nt, inner: 20 } ])",
         R"(shot.yaml:4:33: error: lights.a.luminance does not apply to a light of type point
    lights: [ { id: a, type: point, luminance: 3 nt, inner: 20 } ]
                                    ^~~~~~~~~
  luminance belongs to lights of type area; remove the key or change the type
shot.yaml:4:50: error: lights.a.inner does not apply to a light of type point
    lights: [ { id: a, type: point, luminance: 3 nt, inner: 20 } ]
                                                     ^~~~~
  inner belongs to lights of type spot; remove the key or change the type)"},
        {std::string(kBase) + R"(lights: [ { type: spot, inner: 50, intensity: 3 cd, power: 3 lm } ])",
         R"(shot.yaml:4:32: error: lights.0.inner is 50, wider than outer at 45 deg
    lights: [ { type: spot, inner: 50, intensity: 3 cd, power: 3 lm } ]
                                   ^~
  expected inner to be at most outer; both are half-angles
shot.yaml:4:53: error: lights.0.intensity and lights.0.power exclude each other
    lights: [ { type: spot, inner: 50, intensity: 3 cd, power: 3 lm } ]
                                                        ^~~~~
  remove one of the two)"},
        {std::string(kBase) + R"(lights: [ { id: a, type: area }, { id: a, type: area, size: [0, 1] } ])",
         R"(shot.yaml:4:40: error: two lights have the id 'a'
    lights: [ { id: a, type: area }, { id: a, type: area, size: [0, 1] } ]
                                           ^
  give each light an id of its own
shot.yaml:4:62: error: lights.a.size[0] is 0
    lights: [ { id: a, type: area }, { id: a, type: area, size: [0, 1] } ]
                                                                 ^
  expected [width, height], each more than 0 m)"},
        {std::string(kBase) + R"(lights: [ { id: a } ])",
         R"(shot.yaml:4:11: error: lights.a.type is missing
    lights: [ { id: a } ]
              ^~~~~~~~~
  add `type: spot`)"},
        {std::string(kBase) + R"(lights: [ { id: a, type: point, intensity: -1 cd } ])",
         R"(shot.yaml:4:44: error: lights.a.intensity is -1 cd
    lights: [ { id: a, type: point, intensity: -1 cd } ]
                                               ^~~~~
  expected at least 0 cd)"},
        {std::string(kBase) + R"(environment: { color: [1, 1, 1], image: a.glb })",
         R"(shot.yaml:4:34: error: environment.color and environment.image exclude each other
    environment: { color: [1, 1, 1], image: a.glb }
                                     ^~~~~
  remove one of the two)"},
        {std::string(kBase) + R"(use_scene_lights: yes)",
         R"(shot.yaml:4:19: error: use_scene_lights is 'yes'
    use_scene_lights: yes
                      ^~~
  expected true or false)"},
        {std::string(kBase) + R"(render: { denoise: nlm, build: best, robust: 1, texture_limit: 0 })",
         R"(shot.yaml:4:20: error: render.denoise is 'nlm'
    render: { denoise: nlm, build: best, robust: 1, texture_limit: 0 }
                       ^~~
  expected one of none, oidn
shot.yaml:4:32: error: render.build is 'best'
    render: { denoise: nlm, build: best, robust: 1, texture_limit: 0 }
                                   ^~~~
  expected one of low, medium, high
shot.yaml:4:46: error: render.robust is 1
    render: { denoise: nlm, build: best, robust: 1, texture_limit: 0 }
                                                 ^
  expected true or false or auto
shot.yaml:4:64: error: render.texture_limit is 0
    render: { denoise: nlm, build: best, robust: 1, texture_limit: 0 }
                                                                   ^
  expected 1 to 32768 px or none)"},
        {std::string(kBase) + R"(render: { denoise: oidn, filter: gauss, clamp: { direct: 0 }, seed: -1 })",
         R"(shot.yaml:4:34: error: render.filter is 'gauss'
    render: { denoise: oidn, filter: gauss, clamp: { direct: 0 }, seed: -1 }
                                     ^~~~~
  expected one of box, gaussian, mitchell, blackman-harris or a map of type, width
shot.yaml:4:58: error: render.clamp.direct is 0
    render: { denoise: oidn, filter: gauss, clamp: { direct: 0 }, seed: -1 }
                                                             ^
  expected more than 0 or none
shot.yaml:4:69: error: render.seed is -1
    render: { denoise: oidn, filter: gauss, clamp: { direct: 0 }, seed: -1 }
                                                                        ^~
  expected a whole number from 0 to 4294967295 or a map of value, animated)"},
        {std::string(kBase) + R"(render: { samples: { keys: { 0 s: 1 } } })",
         R"(shot.yaml:4:20: error: render.samples is a map
    render: { samples: { keys: { 0 s: 1 } } }
                       ^~~~~~~~~~~~~~~~~~~~
  expected a whole number from 1 to 1048576 or a map of max_error, at_least, at_most, time_budget, time_budget_shot; this value cannot change over time)"},
        {std::string(kBase) + R"(view: { transform: filmic, exposure: { iso: 100 } })",
         R"(shot.yaml:4:20: error: view.transform is 'filmic'
    view: { transform: filmic, exposure: { iso: 100 } }
                       ^~~~~~
  expected one of none, srgb, agx, aces, pbr-neutral
shot.yaml:4:38: error: view.exposure.time is missing
    view: { transform: filmic, exposure: { iso: 100 } }
                                         ^~~~~~~~~~~~
  give { ev100 }, or { iso, time, f_stop }
shot.yaml:4:38: error: view.exposure.f_stop is missing
    view: { transform: filmic, exposure: { iso: 100 } }
                                         ^~~~~~~~~~~~
  give { ev100 }, or { iso, time, f_stop })"},
        {std::string(kBase) + R"(view: { exposure: bright })",
         R"(shot.yaml:4:19: error: view.exposure is 'bright'
    view: { exposure: bright }
                      ^~~~~~
  expected -200 to 200 stops or auto or a map of ev100, iso, time, f_stop)"},
        {std::string(kBase) + R"(output: { frames: out.tiff })",
         R"(shot.yaml:4:19: error: output.frames is 'out.tiff'
    output: { frames: out.tiff }
                      ^~~~~~~~
  expected a pattern that ends in .exr, .png or .jpg)"},
        {std::string(kBase) + R"(timing: { frames: 0-9 }
output: { frames: out.png })",
         R"(shot.yaml:5:19: error: output.frames is 'out.png', the same file for every frame
    output: { frames: out.png }
                      ^~~~~~~
  expected {frame} or {frame:04} in the pattern of a shot with several frames)"},
        {std::string(kBase) + R"(output: { frames: "{nam}.png" })",
         R"(shot.yaml:4:19: error: output.frames has '{nam}', which is no placeholder
    output: { frames: "{nam}.png" }
                      ^~~~~~~~~~~
  expected {name}, {frame} or {frame:04})"},
        {std::string(kBase) + R"(output: { aovs: [ error, depth, depth, dept ] })",
         R"(shot.yaml:4:33: error: output.aovs[2] is 'depth' again
    output: { aovs: [ error, depth, depth, dept ] }
                                    ^~~~~
  expected each layer once
shot.yaml:4:40: error: output.aovs[3] is 'dept'
    output: { aovs: [ error, depth, depth, dept ] }
                                           ^~~~
  expected one of albedo, normal, depth, motion, samples, error; did you mean 'depth'?)"},
        {std::string(kBase) + R"(output: { png_bits: 12 })",
         R"(shot.yaml:4:21: error: output.png_bits is 12
    output: { png_bits: 12 }
                        ^~
  expected 8 or 16)"},
        {std::string(kBase) + R"(output: { video: a.avi })",
         R"(shot.yaml:4:18: error: output.video is 'a.avi'
    output: { video: a.avi }
                     ^~~~~
  expected a file that ends in .mp4, .mkv, .mov, .webm or .gif)"},
        {std::string(kBase) + R"(output: { video: { file: a.mov, crf: 5 } })",
         R"(shot.yaml:4:38: error: output.video.crf does not apply to prores
    output: { video: { file: a.mov, crf: 5 } }
                                         ^
  remove the key; crf belongs to h264, h265, av1 and vp9)"},
        {std::string(kBase) + R"(output: { video: { codec: h264 } })",
         R"(shot.yaml:4:18: error: output.video.file is missing
    output: { video: { codec: h264 } }
                     ^~~~~~~~~~~~~~~
  add `file: ../output/{name}.mp4`)"},
        {std::string(kBase) + R"(name: !!str x)",
         R"(shot.yaml:4:7: error: the tag 'tag:yaml.org,2002:str' is not part of the format
    name: !!str x
          ^
  expected a value without a tag)"},
        {std::string(kBase) + R"(? [a]
: 1)",
         R"(shot.yaml:4:3: error: a key is not a plain word
    ? [a]
      ^~~
  expected `key: value`)"},
        {std::string(kBase) + R"(x: &a [*a])",
         R"(shot.yaml:4:8: error: an alias stands inside the value it names
    x: &a [*a]
           ^
  expected an alias of a complete value)"},
        {std::string(kBase) + R"(a: &a [0,0,0,0,0,0,0,0,0]
b: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a]
c: &c [*b,*b,*b,*b,*b,*b,*b,*b,*b]
d: &d [*c,*c,*c,*c,*c,*c,*c,*c,*c]
e: &e [*d,*d,*d,*d,*d,*d,*d,*d,*d]
f: [*e,*e,*e])",
         R"(shot.yaml:9:5: error: the aliases expand to a huge document
    f: [*e,*e,*e]
        ^
  expected aliases that stand for at most 100000 values)"},
        {std::string(kBase) +
             R"(name: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[)",
         R"(shot.yaml:4:71: error: the values nest too deeply
    name: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[
                                                                          ^
  expected at most 64 levels)"},
        {std::string(kBase) + R"(output: { frames: ["a.{frame}.png", "a.{frame}.png"] })",
         R"(shot.yaml:4:37: error: output.frames[1] is 'a.{frame}.png', which is already an output
    output: { frames: ["a.{frame}.png", "a.{frame}.png"] }
                                        ^~~~~~~~~~~~~~~
  give each output a path of its own)"},
        {std::string(R"(kadr: 1
scenes: [ a.glb ]
camera: { vertical_fov: 40 mm, sensor: { fit: fill } })"),
         R"(shot.yaml:3:25: error: camera.vertical_fov is 40 mm
    camera: { vertical_fov: 40 mm, sensor: { fit: fill } }
                            ^~~~~
  expected 1e-06 to 179.9 deg; 'mm' is not one of its units (deg, rad)
shot.yaml:3:47: error: camera.sensor.fit is 'fill'
    camera: { vertical_fov: 40 mm, sensor: { fit: fill } }
                                                  ^~~~
  expected one of auto, horizontal, vertical)"},
        {std::string(kBase) + R"(timing: { frames: 0-2000000 })",
         R"(shot.yaml:4:19: error: timing.frames is 0-2000000: more than 1000000 frames
    timing: { frames: 0-2000000 }
                      ^~~~~~~~~
  expected frames as "0-95", "0-95x2" (every second one) or "5,9,12-20")"},
    };
    for (const Case& c : cases) EXPECT_EQ(errors_of(c.text), c.message) << c.text;
}

TEST_F(Messages, NameAFileThatIsMissingAndOneThatIsNear) {
    EXPECT_EQ(errors_of("kadr: 1\nscenes: [ aa.glb ]\ncamera: {}\n"),
              "shot.yaml:2:11: error: scenes.0 is 'aa.glb', which does not exist\n"
              "    scenes: [ aa.glb ]\n"
              "              ^~~~~~\n"
              "  expected a file, looked for as " +
                  (folder_ / "aa.glb").string() + "; did you mean 'a.glb'?");
    EXPECT_EQ(errors_of(kBase + std::string("environment: { image: elsewhere/sky.exr }\n")),
              "shot.yaml:4:23: error: environment.image is 'elsewhere/sky.exr', which does not exist\n"
              "    environment: { image: elsewhere/sky.exr }\n"
              "                          ^~~~~~~~~~~~~~~~~\n"
              "  expected a file, looked for as " +
                  (folder_ / "elsewhere/sky.exr").string());
}

TEST_F(Messages, TellWhatIsNotUtf8) {
    EXPECT_EQ(errors_of("kadr: 1\nname: \"caf\xE9\"\n"),
              "shot.yaml:2:11: error: byte 0xE9 is not UTF-8\n  expected UTF-8 text; save the file in that encoding");
}

TEST_F(Messages, RefuseDeepNesting) {
    const std::string brackets(100000, '[');
    EXPECT_THAT(errors_of(kBase + ("name: " + brackets)),
                ::testing::StartsWith("shot.yaml:4:71: error: the values nest too deeply\n"));
    std::string indented = kBase + std::string("name:\n");
    for (int depth = 1; depth < 400; ++depth) indented += std::string(static_cast<std::size_t>(depth), ' ') + "a:\n";
    EXPECT_THAT(errors_of(indented), ::testing::StartsWith("shot.yaml:68:65: error: the values nest too deeply\n"));
}

TEST_F(Messages, RefuseAliasBombs) {
    std::string bomb = kBase + std::string("l0: &l0 [0, 0, 0, 0, 0, 0, 0, 0, 0]\n");
    for (int i = 1; i < 12; ++i) {
        std::string row = fmt::format("l{0}: &l{0} [", i);
        for (int k = 0; k < 9; ++k) row += fmt::format("{}*l{}", k == 0 ? "" : ", ", i - 1);
        bomb += row + "]\n";
    }
    EXPECT_THAT(errors_of(bomb), ::testing::HasSubstr("error: the aliases expand to a huge document\n"));
}

TEST_F(Messages, RefuseHugeFiles) {
    EXPECT_EQ(errors_of(std::string(kBase) + "# " + std::string(2u << 20, 'x')),
              "shot.yaml: error: the file has 2097191 bytes\n  expected a shot file of at most 2 MiB");
}

TEST_F(Messages, StopAfterAHundred) {
    std::string text = kBase;
    for (int i = 0; i < 150; ++i) text += fmt::format("zzz{}: 1\n", i);
    EXPECT_THAT(errors_of(text), ::testing::EndsWith("\nerror: 50 more errors are not shown"));
}

TEST_F(Messages, ListEveryProblemInTheOrderOfTheFile) {
    const std::string text =
        "kadr: 1\nrender: { samples: 0 }\nscenes: [ a.glb ]\ncamera: { f_stop: x }\nimage: { size: 3 }\n";
    try {
        parse_shot_text(text, "shot.yaml");
        FAIL();
    } catch (const InputError& error) {
        ASSERT_EQ(error.diagnostics().size(), 3u);
        EXPECT_EQ(error.diagnostics()[0].found, "render.samples is 0");
        EXPECT_EQ(error.diagnostics()[1].found, "camera.f_stop is 'x'");
        EXPECT_EQ(error.diagnostics()[2].found, "image.size is 3");
    }
}

TEST_F(Messages, RefuseFilesThatAreNone) {
    EXPECT_THROW(parse_shot("missing.yaml"), InputError);
    EXPECT_THROW(parse_shot("."), InputError);
}

// The example of the format's description: what is not built yet is refused by name, and nothing else is wrong.
TEST_F(Messages, OfTheWholeFormatNameWhatIsNotBuilt) {
    for (const char* name : {"helmet.glb", "tree.glb"}) std::ofstream(folder_ / name);
    const std::string example = R"(kadr: 1
name: helmet-orbit
timing:  { fps: 24, frames: 0-95 }
image:   { size: [1280, 720], pixel_aspect: 1, crop: none }
scenes:
  - id: helmet
    gltf: helmet.glb
    transform: { translate: [0, 0, 0], rotate: [0, 90 deg, 0], scale: 1 }
    animation: { clip: all, start: 0 s, speed: 1, loop: hold }
    nodes:
      Visor/Hinge: { rotate: { keys: { 0 s: [0, 0, 0], 1 s: [70 deg, 0, 0] }, interpolate: smooth } }
    hide: [ Collision ]
    variant: null
  - { id: copies, gltf: tree.glb, instances: { grid: [10, 1, 10], spacing: [2, 0, 2], jitter: 0.3, seed: 7 } }
camera:
  position: { keys: { 0 f: [3, 1.4, 4], 95 f: [-3, 1.4, 4] }, interpolate: smooth }
  look_at: helmet/Visor
  up: [0, 1, 0]
  focal_length: 35 mm
  sensor: { size: [36 mm, 24 mm], fit: auto }
  f_stop: 2.8
  focus: helmet/Visor
  blades: 7
shutter: { angle: 180 deg, phase: centre, exposure: constant }
lights:
  - { id: sun,  type: directional, illuminance: 50000 lux, color: [1, 0.95, 0.9], direction: [-1, -2, -1], angular_diameter: 0.53 deg }
  - { id: key,  type: spot,  intensity: { keys: { 0 s: 0 cd, 2 s: 800 cd } }, position: [2, 3, 2], look_at: helmet, inner: 20 deg, outer: 35 deg, range: 20 m, falloff: gltf }
  - { id: bulb, type: point, power: 800 lm, position: [0, 2, 0], radius: 0.03 m }
  - { id: panel, type: area, size: [1, 0.5], luminance: 2000 nt, position: [-2, 2, 0], look_at: helmet }
environment: { color: [0.53, 0.81, 0.92], strength: 8000 nt }
use_scene_lights: true
render:
  integrator: path
  samples: 64
  bounces: { total: 8, diffuse: 4, glossy: 4, transmission: 8 }
  filter: { type: blackman-harris, width: 1.5 px }
  motion_tolerance: 0.1 px
  clamp: { direct: none, indirect: none }
  denoise: none
  seed: { value: 0, animated: false }
view: { transform: agx, exposure: -14.5 }
output:
  frames: "../output/{name}/{name}.{frame:04}.exr"
  aovs: [ albedo, normal, depth, motion, samples, error ]
  video: { file: "../output/{name}.mp4", codec: h264, crf: 18, pixel_format: yuv420p }
)";
    EXPECT_NO_THROW(parse_shot_text(example, "shot.yaml"));
}

}  // namespace
}  // namespace kadr
