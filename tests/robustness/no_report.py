# Runs a command whose programs were built with sanitizers: no_report.py COMMAND [WORD...]. What address, leak, undefined-behaviour and thread sanitizers of all processes below it find is collected, whatever the
# processes do with their output and exit codes; one report, and the command has failed. Its exit code is handed on else.
import glob
import os
import re
import signal
import subprocess
import sys
import tempfile

tests = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
longest = 20_000  # characters of reports that are shown

# Leaks of libraries, by the function that asked for the memory itself: what it was called by is ours, so that a suppression (lsan.supp), which looks at the whole stack, would hide more.
known_leaks = re.compile("|".join([
    # omniORB 4.2 leaves behind what it has read of a reference whose rest is nonsense.
    r" in omniObjRef::_unMarshal\(", r" in cdrStream::unmarshalRawString\(",
    # The states of connections that are open when the process ends: of omniORB, and of its TLS.
    r" in omni::giopStrand::acquireServer\(", r" in CRYPTO_zalloc ",
    # Functions without a name in Mesa: what the last context of a thread has made there. OSMesaCreateContext... have names.
    r" {2}\(/\S*/libOSMesa\.so"]))


# Nothing but known leaks; those that are only reached from others count with these.
def is_known(report):
    if "ERROR: LeakSanitizer" not in report or report.count("ERROR: ") > 1 or "runtime error: " in report:
        return False
    direct = re.findall(r"^Direct leak .*\n(?: +#\d+ .*(?:operator new|_interceptor_|asan_\w+\.cpp).*\n)* +#\d+ (.*)$", report, re.MULTILINE)
    return len(direct) == report.count("Direct leak ") > 0 and all(known_leaks.search(frame) for frame in direct)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o777)  # some programs run as another account
        common = "log_exe_name=1:print_stacktrace=1"
        settings = {
            # A library that is loaded before all others is not ours to order. A process that is told to end by a signal and one that dies are told apart by the tests. Leaks are judged here, by their
            # report, and not by the exit code; other errors abort.
            "ASAN_OPTIONS": f"verify_asan_link_order=0:handle_segv=1:detect_stack_use_after_return=1:abort_on_error=1:exitcode=0:log_path={folder}/report:{common}",
            "LSAN_OPTIONS": f"suppressions={tests}/lsan.supp:print_suppressions=0:exitcode=0:log_path={folder}/report:{common}",
            "UBSAN_OPTIONS": f"log_path={folder}/report.undefined:{common}",  # its runtime is another one, which would write over the file
            "TSAN_OPTIONS": f"suppressions={tests}/tsan.supp:print_suppressions=0:log_path={folder}/report:{common}",
        }
        # What was set outside counts, but for what is said here.
        environment = {**os.environ, "RTMSIM_SANITIZED": "1", **{name: f"{os.environ.get(name, '')}:{words}".strip(":") for name, words in settings.items()}}
        command = subprocess.Popen(sys.argv[1:], env=environment)
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda number, _: command.send_signal(number))
        code = command.wait()
        reports = []
        for path in sorted(glob.glob(f"{folder}/report*")):
            with open(path, errors="replace") as file:
                report = file.read()
            if not is_known(report):
                reports.append(f"--- {os.path.basename(path)}\n{report}")
    if reports:
        print("\n".join(reports)[:longest], file=sys.stderr)
        sys.exit(f"no_report: {len(reports)} processes were reported on")
    sys.exit(code if code >= 0 else 128 - code)


if __name__ == "__main__":
    main()
