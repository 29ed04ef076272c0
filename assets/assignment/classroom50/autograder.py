"""Autograder of Classroom 50: grades the checkout in the current folder and writes result.json.

Files beside this one are published with the classroom's pages, so students can read them. It therefore plays public seeds;
mark with your secret seeds on your own computer.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROGRAM = HERE / "wildfire"
RESULT = Path("result.json")


def main():
    PROGRAM.chmod(0o755)
    RESULT.unlink(missing_ok=True)
    command = [PROGRAM, "grade", ".", "--rules", HERE / "rules.toml", "--seeds", f"@{HERE / 'public.csv'}"]
    options = ["--trust", "--quiet", "--for", "classroom50", "--out", RESULT]
    # The exit code says whether runs failed; the grade is in the file in any case.
    subprocess.run(command + options, check=False)
    if not RESULT.is_file():
        sys.exit("the entry could not be graded; see the message above")
    submitted = subprocess.run(
        ["git", "log", "-1", "--date=format-local:%Y-%m-%dT%H:%M:%SZ", "--format=%cd"],
        env={**os.environ, "TZ": "UTC"}, capture_output=True, text=True, check=True,
    )
    grade = json.loads(RESULT.read_text())
    result = {
        "schema": grade.pop("schema"),
        "classroom": os.environ["CLASSROOM"],
        "assignment": os.environ["ASSIGNMENT"],
        "assignment_type": os.environ.get("ASSIGNMENT_TYPE", "individual"),
        "owner": os.environ["OWNER"],
        "submission": os.environ["SUBMISSION_TAG"],
        "commit": os.environ["COMMIT_URL"],
        "release": os.environ["RELEASE_URL"],
        "review": os.environ.get("REVIEW_URL") or os.environ["COMMIT_URL"],
        "datetime": submitted.stdout.strip(),
        **grade,
    }
    RESULT.write_text(json.dumps(result, indent=2) + "\n")


main()
