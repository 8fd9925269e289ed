"""Where the GPU kernels' compilers and HIPRT's device headers are; brings what a package index carries into a cache.

Nothing here needs a GPU. What is missing is a Missing with the reason in one sentence.
"""

import ctypes
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

# A wheel that carries HIPRT's device headers (version 2.5, MIT licence) among much else: only they are read out of it.
HEADER_WHEEL = ("bpy", "5.0.1", "3.11", "/device/hiprt/hiprt/")
NVRTC_WHEEL = "nvidia-cuda-nvrtc-cu12"


class Missing(Exception):
    pass


def cache_folder():
    if os.environ.get("KADR_CACHE"):
        return Path(os.environ["KADR_CACHE"]) / "gpu-tools"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "kadr" / "gpu-tools"


class Headers:
    """An include folder that holds hiprt/, and what to call its version."""

    def __init__(self, folder, name):
        self.folder, self.name = folder, name


def holds_headers(folder):
    return (folder / "hiprt" / "impl" / "hiprt_device_impl.h").exists()


def version_of(folder):
    """By hiprt.h, which releases carry; else by the content."""
    released = folder / "hiprt" / "hiprt.h"
    if released.exists():
        found = dict(re.findall(r"define\s+HIPRT_(MAJOR|MINOR)_VERSION\s+(\d+)", released.read_text(errors="replace")))
        if len(found) == 2:
            return f"hiprt {found['MAJOR']}.{found['MINOR']}"
    content = b"".join(p.read_bytes() for p in sorted((folder / "hiprt").rglob("*.h")))
    return "hiprt " + hashlib.sha256(content).hexdigest()[:8]


def hiprt_headers():
    """HIPRT_ROOT's headers, else the cache's, which are brought when they are not there."""
    root = os.environ.get("HIPRT_ROOT")
    if root:
        for folder in (Path(root) / "include", Path(root)):
            if holds_headers(folder):
                return Headers(folder, version_of(folder))
        print(f"error: HIPRT_ROOT is {root}, which holds no include/hiprt/impl/hiprt_device_impl.h; expected the folder of a "
              "HIPRT release", file=sys.stderr)
        sys.exit(2)
    name, version, _, _ = HEADER_WHEEL
    folder = cache_folder() / f"hiprt-of-{name}-{version}"
    if not holds_headers(folder):
        fetch_headers(folder)
    return Headers(folder, f"{name} {version}")


def fetch_headers(folder):
    """Reads the headers out of the wheel by ranges, through pip's own settings; a hundredth of a percent of the wheel."""
    name, version, python, inside = HEADER_WHEEL
    try:
        from pip._internal.commands.download import DownloadCommand
        from pip._internal.network.lazy_wheel import LazyZipOverHTTP
    except ImportError as error:
        raise Missing(f"HIPRT_ROOT is not set, and pip cannot read parts of a wheel ({error})")
    command = DownloadCommand("download", "")
    try:
        options, _ = command.parse_args(["--quiet", "--no-deps", "--only-binary=:all:", "--python-version", python, f"{name}=={version}"])
        with command.main_context():
            session = command.get_default_session(options)
            finder = command._build_package_finder(options=options, session=session, target_python=make_target_python(options))
            found = [c for c in finder.find_all_candidates(name) if str(c.version) == version and c.link.is_wheel]
            if not found:
                raise Missing(f"HIPRT_ROOT is not set, and no index has the wheel {name} {version}, which carries HIPRT's headers")
            with zipfile.ZipFile(LazyZipOverHTTP(found[0].link.url_without_fragment, session)) as wheel:
                unpack(wheel, inside, folder)
    except Missing:
        raise
    except Exception as error:  # the network, in all its ways
        raise Missing(f"HIPRT_ROOT is not set, and the wheel {name} {version} cannot be read: {type(error).__name__}: {error}")


def make_target_python(options):
    from pip._internal.cli.cmdoptions import make_target_python as make
    return make(options)


def unpack(wheel, inside, folder):
    partial = folder.with_name(f"{folder.name}.{os.getpid()}")
    for entry in wheel.infolist():
        if inside in entry.filename and not entry.is_dir():
            path = partial / "hiprt" / entry.filename.split(inside)[1]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(wheel.read(entry))
    try:
        partial.rename(folder)
    except OSError:  # another process was first
        shutil.rmtree(partial)


class RuntimeCompiler:
    """A run-time compiler: NVRTC, or hiprtc, whose interface is the same but for the prefix of its names."""

    def __init__(self, library, prefix):
        try:
            self.library, self.prefix = ctypes.CDLL(library), prefix
        except OSError as error:
            raise Missing(f"{prefix} cannot be opened: {error}")

    def call(self, name, *arguments):
        return getattr(self.library, self.prefix + name)(*arguments)

    def compile(self, source, options):
        """@return (whether it compiled, the log)"""
        program = ctypes.c_void_p()
        self.call("CreateProgram", ctypes.byref(program), source.encode(), b"kernel.cu", 0, None, None)
        arguments = (ctypes.c_char_p * len(options))(*[option.encode() for option in options])
        status = self.call("CompileProgram", program, len(options), arguments)
        size = ctypes.c_size_t()
        self.call("GetProgramLogSize", program, ctypes.byref(size))
        log = ctypes.create_string_buffer(size.value + 1)
        self.call("GetProgramLog", program, log)
        self.call("DestroyProgram", ctypes.byref(program))
        return status == 0, log.value.decode(errors="replace")


class Nvrtc(RuntimeCompiler):
    """The one that HIPRT compiles with on NVIDIA's GPUs."""

    def __init__(self):
        super().__init__(nvrtc_library(), "nvrtc")
        major, minor = ctypes.c_int(), ctypes.c_int()
        self.library.nvrtcVersion(ctypes.byref(major), ctypes.byref(minor))
        self.name = f"nvrtc {major.value}.{minor.value}"


class Hiprtc(RuntimeCompiler):
    """The one that HIPRT compiles with on AMD's GPUs; part of the HIP runtime."""

    name = "hiprtc"

    def __init__(self):
        found = sorted(glob.glob("/usr/lib/*/libamdhip64.so*") + glob.glob("/opt/rocm*/lib/libamdhip64.so*"))
        if not found:
            raise Missing("libamdhip64 is not installed (Debian: libamdhip64-5)")
        super().__init__(found[0], "hiprtc")


def nvrtc_library():
    roots = [os.environ.get("CUDA_PATH"), os.environ.get("CUDA_HOME"), "/usr/local/cuda"] + sorted(glob.glob("/usr/local/cuda-*"), reverse=True)
    for root in filter(None, roots):
        for library in sorted(glob.glob(f"{root}/lib64/libnvrtc.so*")):
            return library
    packages = cache_folder() / NVRTC_WHEEL
    if not nvrtc_in(packages):
        install_nvrtc(packages)
    if not nvrtc_in(packages):
        raise Missing(f"there is no CUDA toolkit, and {NVRTC_WHEEL} holds no libnvrtc.so")
    return nvrtc_in(packages)


def nvrtc_in(packages):
    return next(iter(sorted(glob.glob(f"{packages}/nvidia/**/libnvrtc.so*", recursive=True))), None)


def install_nvrtc(packages):
    pip = subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", packages, NVRTC_WHEEL],
                         capture_output=True, text=True)
    if pip.returncode != 0:
        raise Missing(f"there is no CUDA toolkit, and pip cannot install {NVRTC_WHEEL}: {(pip.stderr.strip().splitlines() or ['?'])[-1]}")


class Hipcc:
    """AMD's compiler as Debian has it."""

    def __init__(self):
        self.program = shutil.which("hipcc")
        if not self.program:
            raise Missing("hipcc is not installed (Debian: hipcc libamdhip64-dev)")
        if not glob.glob("/usr/include/hip/hip_runtime.h") and not glob.glob("/opt/rocm*/include/hip/hip_runtime.h"):
            raise Missing("hip/hip_runtime.h is not installed (Debian: libamdhip64-dev)")
        version = subprocess.run([self.program, "--version"], capture_output=True, text=True, env=self.environment()).stdout
        found = re.search(r"HIP version: (\d+\.\d+)", version)
        self.name = f"hipcc {found.group(1) if found else 'of unknown version'}"

    @staticmethod
    def environment():
        return dict(os.environ, HIP_PLATFORM="amd")

    def compile(self, source, options):
        """@return (whether it compiled, the log)"""
        done = subprocess.run([self.program, "-x", "hip", "--genco", *options, "-", "-o", "/dev/null"], input=source,
                              capture_output=True, text=True, env=self.environment())
        return done.returncode == 0, done.stdout + done.stderr
