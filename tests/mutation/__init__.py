"""Mutation by sample: are small faults in a room's sources noticed by its tests?"""
