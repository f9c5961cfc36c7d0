# Which words of a source called_programs.py takes for programs, and what it reports.
import collections
import pathlib
import tempfile
import unittest

from called_programs import OPTIONAL, called, problems, python_commands, shell_commands

SHELL = """#!/bin/bash
# comment of a comment
set -e; names=(one two) # more
first --option word | second >file 2>&1 && ! third || { fourth; }
if fifth; then sixth; elif [ -e x ]; then VALUE=1 seventh; fi
case "$1" in --help | -h) eighth ;; word) ninth ;; esac
for word in a b; do tenth "$word"; done; for ((i = 0; i < 3; ++i)); do :; done
said=$(eleventh "$(twelfth word)") && echo "in text: $(thirteenth)" 'not $(this)'
trap 'fourteenth word; exit' EXIT
env A=b nice -n 10 fifteenth; timeout -s TERM 2 sixteenth; command -v seventeenth >/dev/null
sh -c "eighteenth && $later"
python3 -c 'import this; print(that)'
own() { nineteenth; }
own word
cat <<'END'
text of a document
END
"$variable" word; folder/program word
diff <(twentieth) file
"""

PYTHON = """import subprocess
subprocess.run(["first", "word"], check=True)
subprocess.check_output("second | third", shell=True)
subprocess.run(["sh", "-c", "fourth && fifth"])
run("sixth", "word")
apart = ["seventh", *user, "--mount"]
words = ["apple", "pear"]
"""


class CalledPrograms(unittest.TestCase):
    def test_commands_of_a_shell_script_are_found_and_its_words_are_not(self):
        counted = """first second third fourth fifth sixth seventh eighth ninth tenth eleventh twelfth thirteenth fourteenth fifteenth sixteenth seventeenth eighteenth nineteenth
                     twentieth""".split()
        self.assertEqual(shell_commands(SHELL) - {"own"}, {*counted, "env", "nice", "timeout", "sh", "python3", "cat", "diff"})

    def test_commands_of_a_python_source_are_found_and_its_lists_are_not(self):
        self.assertEqual(python_commands(PYTHON), ({"first", "second", "third", "sh", "fourth", "fifth"}, {"sh", "sixth", "seventh"}))

    def test_a_program_or_module_that_setup_does_not_install_is_named_with_its_caller(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder)
            (source / "tests").mkdir()
            (source / "tests/one").write_text("#!/bin/sh\nplain && beside && absent && ours && own\nown() { for program in plain named; do :; done; }\n")
            (source / "tests/two.py").write_text("import os.path, numpy\nfrom venv import x\nimport three\nfrom . import four\n")
            (source / "tests/three.py").write_text("import sys\n")
            sure, likely, modules = called(source)
        self.assertEqual(modules, {"numpy": {"tests/two.py"}, "venv": {"tests/two.py"}})
        self.assertEqual(likely, {})
        for name in OPTIONAL:
            sure[name].add("tests/one")
        places = collections.defaultdict(lambda: None, {name: f"/usr/bin/{name}" for name in ("plain", "beside", "named")})
        owner = {"/bin/plain": "good", "/bin/beside": "bad", "/bin/named": "bad"}
        found = problems(sure, likely, {"good"}, {"ours"}, owner, places.get)
        self.assertEqual(found, ["absent: not installed here; called by tests/one", "beside: of package bad, which scripts/setup does not install; called by tests/one",
                                 "named: of package bad, which scripts/setup does not install; called by tests/one"])

    def test_a_program_that_nothing_calls_is_no_exception_any_more(self):
        self.assertEqual(problems({}, {}, set(), set(), {})[0].split(":")[1], " called by nothing; take it out of OPTIONAL")


unittest.main()
