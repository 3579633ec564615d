"""A pool of processes for proofs, which ends soon where it is interrupted."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.context import BaseContext


@contextmanager
def processes(count: int, context: BaseContext | None = None) -> Iterator[ProcessPoolExecutor]:
    """Yield a pool; where the block is left by an exception, what has not begun is not begun any more."""
    with ProcessPoolExecutor(count, context) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
