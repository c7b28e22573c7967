"""physim: a physics-backed simulator for multi-robot control in confined space.

    world = physim.load_world("my_world.yaml")
    record = physim.simulate(world)
    print(record.contacts, physim.summarise(record))

Step by step::

    simulation = physim.Simulation(world, seed=3)
    while not simulation.finished:
        simulation.step()

The public names are listed in ``__init__.pyi`` and imported when first used, so ``import physim``
is quick.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
