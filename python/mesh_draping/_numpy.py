"""numpy, imported when the first array is asked for: a drape from file to file needs none, and half its memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[Any]
else:

    class _Later:
        """The module, from its first use on."""

        def __getattr__(self, name: str) -> Any:
            import numpy

            return getattr(numpy, name)

    np = _Later()
    Array = Any

__all__ = ["Array", "np"]
