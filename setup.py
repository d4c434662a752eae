"""Lets colcon and pip find the declarative setup.cfg."""

from setuptools import setup

setup()
