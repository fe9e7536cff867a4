# SPDX-License-Identifier: AGPL-3.0-or-later
"""Makes a wheel of the package that CMake has put together in the build folder (`./run python`)."""
from setuptools import Distribution, setup


class BinaryDistribution(Distribution):
    """The package holds machine code, so its wheel is of one platform."""

    def has_ext_modules(self):
        return True


setup(
    name="limber",
    version="@PROJECT_VERSION@",
    description="Poses labelled voxel anatomy",
    license="AGPL-3.0-or-later",
    python_requires=">=3.9",
    install_requires=["numpy"],
    packages=["limber"],
    package_data={"limber": ["*", "assets/*/*"]},
    exclude_package_data={"limber": [".complete"]},
    distclass=BinaryDistribution,
)
