"""What the site's pages take from the code when it is built."""
