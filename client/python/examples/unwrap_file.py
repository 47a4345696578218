"""python3 unwrap_file.py IN OUT: unwraps a file by the server at UNWRAPD_SERVER."""

import sys
from pathlib import Path

from unwrapd import Progress, unwrap


def tell(progress: Progress) -> None:
    print(f"{100 * progress.fraction:.0f} % {progress.event}", file=sys.stderr)


done = unwrap(sys.argv[1], {"preset": "texture"}, on_progress=tell)
Path(sys.argv[2]).write_bytes(done.asset)
print(f"{len(done.report['charts'])} charts, D_angle {done.report['distortion']['angle']:.4f}")
