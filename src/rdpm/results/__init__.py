"""What a run left: the files of its folder, and what they say."""
